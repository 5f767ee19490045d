"""The pieces of the report's page."""

import base64
from xml.etree import ElementTree

import cv2
import numpy as np
from gemheads.app.evaluation.report.curves import curve_svg
from gemheads.app.evaluation.report.pictures import CELL_SIDE, STRIP, STRIP_HEIGHT, Gallery, choose, data_url
from gemheads.app.evaluation.report.summary import means


def unpacked(url: str) -> np.ndarray:
    data = base64.b64decode(url.removeprefix("data:image/jpeg;base64,"))
    return cv2.imdecode(np.frombuffer(data, np.uint8), cv2.IMREAD_COLOR)[..., ::-1]


def test_worst_median_and_best_are_shown() -> None:
    choice = choose([30, 10, 20, 50, 40])
    assert choice.compared == {"worst": 1, "median": 0, "best": 3}
    assert choice.strip == (0, 1, 2, 3, 4)
    assert choose([1.0]).compared == {"worst": 0}
    many = choose(np.arange(100.0).tolist())
    assert len(many.strip) == STRIP
    assert many.strip[0] < 100 / STRIP
    assert many.strip[-1] > 99 - 100 / STRIP


def test_pictures_are_small_and_keep_colour_and_shape() -> None:
    gallery = Gallery(choose([1.0, 2.0]))
    orange = np.full((400, 800, 3), (250, 120, 10), np.uint8)
    upright = np.full((800, 400, 3), (10, 120, 250), np.uint8)
    for place, image in enumerate((orange, upright)):
        gallery.add("a", place, image, np.zeros_like(image))
    gallery.end_row("a")
    drawn = unpacked(gallery.drawn["a", 0])
    assert drawn.shape == (CELL_SIDE // 2, CELL_SIDE, 3)
    np.testing.assert_allclose(drawn.mean((0, 1)), (250, 120, 10), atol=3)
    assert unpacked(gallery.errors["a", 1]).max() < 5
    strip = unpacked(gallery.strips["a"])
    assert strip.shape == (STRIP_HEIGHT, STRIP_HEIGHT + STRIP_HEIGHT // 2, 3)
    np.testing.assert_allclose(strip[:, -20:].mean((0, 1)), (10, 120, 250), atol=3)


def test_data_url_is_rgb() -> None:
    red = unpacked(data_url(np.full((8, 8, 3), (255, 0, 0), np.uint8)))
    assert red[..., 0].min() > 240
    assert red[..., 1:].max() < 15


def test_a_curve_puts_larger_values_higher_and_leaves_gaps() -> None:
    svg = curve_svg("PSNR", {"a<b": [20.0, None, 30.0], "c": [25.0, 25.0, 25.0]}, ["x", "y", "z"], 1)
    dots = list(ElementTree.fromstring(svg).iter("circle"))
    assert [dot[0].text for dot in dots[:2]] == ["a<b, x: 20.0", "a<b, z: 30.0"]
    low, high, middle = (float(dot.attrib["cy"]) for dot in dots[:3])
    assert high < middle < low
    assert ">20.0<" in svg
    assert ">25.0<" in svg
    assert curve_svg("LPIPS", {"a": [None]}, ["x"], 4) == ""
    assert "nan" not in curve_svg("L1", {"a": [0.0]}, ["x"], 4)


def test_a_curve_of_many_pictures_is_lines_alone_in_given_colours() -> None:
    series = {"driver": [0.1, None, 0.3], "avatar": [0.2, 0.2, 0.2]}
    svg = curve_svg("jawOpen", series, ["0 s", "1 s", "2 s"], 2, colors=["#444444", "#0072b2"], dots=False)
    assert "<circle" not in svg
    lines = list(ElementTree.fromstring(svg).iter("polyline"))
    assert [line.attrib["stroke"] for line in lines] == ["#444444", "#0072b2"]
    assert len(lines[0].attrib["points"].split()) == 2


def test_means_leave_out_what_was_not_measured() -> None:
    assert means([{"L1": 0.1, "FLIP": None}, {"L1": 0.3, "FLIP": None}]) == {"L1": 0.2, "FLIP": None}
    assert means([]) == {}
