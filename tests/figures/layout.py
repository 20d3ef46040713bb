"""Laws that hold for every picture."""

import re


def assert_axes_have_units(figure):
    """An axis whose ticks have numbers says what they are, with a unit."""
    figure.draw_without_rendering()
    for panel in figure.axes:
        for axis in (panel.xaxis, panel.yaxis):
            texts = [label.get_text() for label in axis.get_ticklabels() if label.get_visible() and label.get_text()]
            numbers = [text for text in texts if re.fullmatch(r"\W?[\d.]+", text)]
            if numbers:
                assert re.search(r"\(.+\)$", axis.get_label_text()), (panel.get_title(loc="left"), numbers)


def assert_legends_cover_nothing(figure):
    """They are within the figure, and over no panel and no other text."""
    figure.draw_without_rendering()
    legends = [*figure.legends, *(panel.get_legend() for panel in figure.axes if panel.get_legend())]
    texts = [*figure.texts, *(title for panel in figure.axes for title in (panel.title, panel._left_title))]
    assert legends
    for legend in legends:
        box = legend.get_window_extent()
        assert not [panel for panel in figure.axes if box.overlaps(panel.get_window_extent())]
        assert not [t.get_text() for t in texts if t.get_text() and box.overlaps(t.get_window_extent())]
        assert not [other for other in legends if other is not legend and box.overlaps(other.get_window_extent())]
        assert figure.bbox.x0 <= box.x0 and box.x1 <= figure.bbox.x1


def legend_texts(panel):
    return [text.get_text() for text in panel.get_legend().get_texts()] if panel.get_legend() else []
