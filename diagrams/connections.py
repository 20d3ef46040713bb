"""What an input port of a Diagram under construction is connected to, and how to put systems in between."""

from collections.abc import Callable

from pydrake.systems.framework import DiagramBuilder, InputPort, OutputPort


def source_of(builder: DiagramBuilder, port: InputPort) -> OutputPort | None:
    """The output port that an input port is connected to; None if there is none."""
    connected = builder.connection_map().get((port.get_system(), port.get_index()))
    if connected is None:
        return None
    system, index = connected
    return system.get_output_port(index)


def reroute(builder: DiagramBuilder, port: InputPort, through: Callable[[OutputPort], OutputPort]) -> None:
    """Connects an input port, which has a source, to what a function makes of this source.

    through: may add systems to the builder, and returns the port of one of them, or the source itself.
    """
    source = source_of(builder, port)
    assert source is not None
    changed = through(source)
    builder.Disconnect(source, port)
    builder.Connect(changed, port)
