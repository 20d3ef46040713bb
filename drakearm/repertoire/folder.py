"""The folder in which a policy learns a repertoire: the names of its files."""

FILES = {
    "repertoire": "repertoire.yaml",
    "library": "library.npz",
    "held_out": "held_out.npz",
    "policy": "policy.safetensors",
    "log": "training.csv",
    "errors": "errors.json",
    "picture": "errors.png",
}
CHECKPOINT = "checkpoint.safetensors"  # while a training is not finished
