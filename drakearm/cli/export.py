"""`drakearm export`."""

import os
from pathlib import Path
from typing import Annotated

import typer

from drakearm.cli.console import say
from drakearm.cli.folders import existing_run, recorded_run_folder
from drakearm.cli.new_file import prepare_new_file
from drakearm.cli.options import Import, complete_scenario, name_or_path, path
from drakearm.cli.own_code import import_own_code


def export(
    run: Annotated[
        str,
        typer.Argument(
            help="The folder of a run, or the name or file of a SCENARIO, whose run lies in runs/SCENARIO.",
            metavar="RUN",
            parser=name_or_path,
            autocompletion=complete_scenario,
        ),
    ],
    csv: Annotated[bool, typer.Option("--csv", help="A table for pandas and spreadsheets, in SI and radians.")] = False,
    sto: Annotated[
        bool, typer.Option("--sto", help="A table for OpenSim, with the paths of its states, in SI and radians.")
    ] = False,
    mot: Annotated[
        bool, typer.Option("--mot", help="The joint angles in degrees, as a motion for OpenSim's GUI.")
    ] = False,
    out: Annotated[
        Path | None,
        typer.Option(
            "--out",
            help="The file. Its name ends like the format. [default: SCENARIO.csv, .sto or .mot]",
            metavar="FILE",
            parser=path,
            show_default=False,
        ),
    ] = None,
    coordinates: Annotated[
        str | None,
        typer.Option(
            "--coordinates",
            help="What the joints are called in your OpenSim model: JOINT/COORDINATE for each, with commas between "
            "them. [default: the arm's names for both, as in shoulder/shoulder,elbow/elbow]",
            metavar="NAMES",
            show_default=False,
        ),
    ] = None,
    overwrite: Annotated[bool, typer.Option("--overwrite", help="Replace an earlier file.")] = False,
    imports: Import = None,
) -> None:
    """Write the movement of an evaluated run as a table for other programs.

    It has what `drakearm evaluate` recorded without noise, every 10 ms: angles, speeds, reference, excitations,
    activations, fiber lengths and velocities, tendon forces, path lengths, joint moments, powers, and the hand.
    A scenario that is not evaluated yet is evaluated first, with the policy of its run or the one that drakearm ships.

    `drakearm export reach-045 --csv`, then `pandas.read_csv("reach-045.csv")`: columns such as `q_elbow_rad`.

    `drakearm export reach-045 --mot --coordinates r_shoulder/r_shoulder_elev,elbow/elbow_flexion`: then open the
    authors' 14muscles.osim in OpenSim's GUI, and load the motion.
    """
    import_own_code(imports)
    chosen = [suffix for suffix, given in ((".csv", csv), (".sto", sto), (".mot", mot)) if given]
    if len(chosen) != 1:
        raise typer.BadParameter("expected one of --csv, --sto and --mot.")
    from drakearm.experiments.export import export_recording
    from drakearm.model import Recording

    with existing_run(run) if os.path.isdir(run) else recorded_run_folder(run, None) as folder:
        recording = Recording.load(folder.existing("recording", f"evaluate {run}"))
        scenario = folder.scenario()
        file = out or Path(f"{scenario.name}{chosen[0]}")
        prepare_new_file(file, "table", chosen[0], overwrite)
        export_recording(recording, scenario.loaded_arm, file, coordinates.split(",") if coordinates else None)
    say(f"wrote {file}")
