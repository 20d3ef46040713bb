"""The values and texts that mutations put into files."""

# fmt: off
NUMBERS = [0, -1, 1, 2, 3, 0.1, -0.5, 7.5, 1e-300, 1e-12, 1e-4, 1e4, 1e9, 1e12, 1e30, 1e300, 1e308, -1e308, 2**63]
COSTS = [
    {"type": "hand_position", "position": [0.1, -0.25, None], "running": 1, "final": 10},
    {"type": "hand_position", "position": [None, 1e6, None], "final": 1e300},
    {"type": "torque", "weight": [1]},
    {"type": "duration", "weight": 0.5},
    {"type": "posture", "running": [1e-300], "final_speed": 1e12},
]
VALUES = [
    *NUMBERS, *COSTS, None, True, False,
    "", " ", "x", "1", "1e3", "elbow", "flexor", "forearm", "rest", "free", "paper", "rigid", "degroote2016", "é" * 50,
    "a" * 500, "../../x", "/", ".", "..", "a/b", "a\\b", "a\0b", "\x1b[31m", "[/red]x", "[bold]x", "<script>", "\u202e",
    "%s{0}", "2020-01-01", "nan", "inf", "-", "~",
    [], {}, [[]], [[[]]], {"type": [[]]}, [{"type": [[]]}], [None], [True], ["x"], [1, 2], [1] * 1000, {"": ""},
    {"x": {"x": {}}}, [1e308, -1e308], [0.5, 0.1], [0.05, 0.2],
]
RAW_YAML = [
    "2020-01-01", "2020-01-01T10:00:00Z", ".nan", ".inf", "-.inf", "1e400", "-1e400", "1" * 5000, "=", "0x1F", "1_000",
    "1:30", "yes", "!!python/object/apply:os.getcwd []", "!!python/name:os.system", "!!binary aGVsbG8=", "!!set {a, b}",
    "!!timestamp 2020", "!!float x", "!own {a: 1}", "&anchor [*anchor]", "*unknown", "&a [&b [*a], *b]", "{<<: {a: 1}}",
    "{<<: [1]}", "{1: 2}", "{null: 2}", "{[1]: 2}", "{a: 1, a: 2}", "[" * 10_000, "[" * 60 + "]" * 60,
    "{a: " * 60 + "}" * 60, "'", "[1, 2", "{a: [}", "? x", "@", "`", "%", '"\\x00"', '"\\ud800"',
    "[&x0 [1, 1, 1, 1], " + ", ".join(f"&x{i + 1} [{', '.join([f'*x{i}'] * 9)}]" for i in range(9)) + "]",
]
RAW_JSON = [
    "NaN", "Infinity", "-Infinity", "1e999", "1" * 5000, "[" * 10_000, "[" * 60 + "]" * 60, '{"a":1,"a":2}', "'x'", "-",
    "undefined", "\\", '"\\ud800"', '"\\u0000"', "01", "[1,]", "{}x", "//",
]
TEXTS = ["", "\0", "\ufeff", "---\n", "...\n", "--- a\n--- b\n", "null", "[]", "{}", "5", "words", "\t", "%YAML 9\n"]
BYTES = [b"\0", b"\xff\xfe", b"\xc3", b"\x1b[31m", b"\r", b"\t", b"\xed\xa0\x80", b"\xe2\x80\xae"]
XML_VALUES = [
    "", "x", "nan", "inf", "1e999", "-1", "0", "1", "1e308", "1e-308", "1 2", "0 0 0", "1 2 3 4", "nan nan nan",
    "world", "base", "forearm", "hand", "elbow", "fixed", "prismatic", "continuous", "floating", "planar", "ball",
    "universal", "unknown", "1e5 1e5 1e5", "0 0 1e-300", "&lt;", "é", "a" * 5000, "/", "../x", "\0", "3",
]
XML_PIECES = [
    '<link name="forearm"/>', '<link name="other"/>', '<joint name="elbow" type="revolute"/>',
    '<joint name="loose" type="floating"><parent link="world"/><child link="forearm"/></joint>',
    '<link name="tip"/><joint name="slide" type="prismatic"><parent link="hand"/><child link="tip"/></joint>',
    '<mimic joint="elbow" multiplier="2"/>',
    '<transmission name="t"><type>SimpleTransmission</type><joint name="elbow"/><actuator name="m"/></transmission>',
    "<geometry><mesh filename='/dev/zero'/></geometry>",
    "<visual><geometry><mesh filename='none.obj'/></geometry></visual>",
    "<collision><geometry><box size='1 1'/></geometry></collision>", "<drake:proximity_properties/>",
    "<frame name='f' link='none'/>", "<include filename='/etc/hostname'/>", "<inertial><mass value='0'/></inertial>",
    "<inertial><mass value='-1'/><inertia ixx='1' iyy='1' izz='9' ixy='0' ixz='0' iyz='0'/></inertial>",
    "<limit lower='2' upper='1'/>", "<dynamics damping='-1' friction='1e300'/>", "<!--", "]]>", "<a>" * 5000,
    "<robot name='inner'/>", "text",
]
_ENTITIES = [f'<!ENTITY {"abcdefghi"[k]} "{("&" + "abcdefghi"[k - 1] + ";") * 10}">' for k in range(1, 9)]
XML_BOMB = f"<!DOCTYPE r [<!ENTITY a 'aaaaaaaaaa'>{''.join(_ENTITIES)}]>"
