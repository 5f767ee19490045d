"""What is on the screen, on EGL: where things are and what they do, never the shapes of letters."""

from dataclasses import replace
from typing import Any

import numpy as np
import pytest
from gemheads.app.desk import theme
from gemheads.app.desk.actions import BY_NAME, Order
from gemheads.app.desk.layout import laid_out
from gemheads.app.desk.offscreen import DeskOffscreen
from gemheads.app.desk.panels.help import is_on
from gemheads.app.desk.state import DeskState, Exploring
from gemheads.app.desk.view import AvatarFacts, Curve, DeskView, OutputLine, Readings, Rest, Toast
from gemheads.app.live import NO_SHIFT
from gemheads.app.performing.performance import Pose
from gemheads.app.performing.shots import Health, Shot

from .conftest import SIZE

ACCENT = np.array(theme.ACCENT[:3]) * 255
GROUND = np.array(theme.GROUND[:3]) * 255
LEFT_HALF, RIGHT_HALF = (200, 40, 40), (40, 40, 200)


def view(**state: Any) -> DeskView:
    """A window in which all is well."""
    return DeskView(
        state=DeskState(**{"welcome": False, **state}),
        avatars=("anna", "berta", "carla"),
        avatar=AvatarFacts("anna", "", 15000, {"position": 50, "rotation": 50, "scale": 50, "opacity": 50}, 12.0),
        health=Health("tracking", source="Camera", rate=30),
        readings=Readings(fps=30, stages={"draw": 0.01}, engine="software"),
    )


def halves(side: int = 64) -> np.ndarray:
    """A picture, red to the left and blue to the right."""
    picture = np.empty((side, side, 3), np.uint8)
    picture[:, : side // 2], picture[:, side // 2 :] = LEFT_HALF, RIGHT_HALF
    return picture


def shown(desk: DeskOffscreen, what: DeskView, picture: np.ndarray | None = None) -> np.ndarray:
    """The third frame: cards need two to find their size."""
    for _ in range(3):
        desk.show(picture, what)
    return desk.pixels().astype(int)


def part(pixels: np.ndarray, what: DeskView, name: str = "picture") -> np.ndarray:
    area = getattr(laid_out(what, *SIZE), name)
    top, left = round(area.top), round(area.left)
    return pixels[top : top + round(area.height), left : left + round(area.width)]


def share(pixels: np.ndarray, colour: Any, within: float = 30) -> float:
    """Share of pixels of about this colour."""
    return float((np.abs(pixels - np.asarray(colour)).max(-1) < within).mean())


def test_the_picture_is_as_large_as_it_fits_and_mirrored_for_the_person_only(desk: DeskOffscreen) -> None:
    for mirrored, (left, right) in ((False, (LEFT_HALF, RIGHT_HALF)), (True, (RIGHT_HALF, LEFT_HALF))):
        what = view(mirror=mirrored)
        middle = part(shown(desk, what, halves()), what)
        side = min(middle.shape[:2])
        assert share(middle, LEFT_HALF) + share(middle, RIGHT_HALF) == pytest.approx(
            side**2 / middle[..., 0].size, abs=0.02
        )
        centre = middle.shape[1] // 2
        assert (np.abs(middle[300, centre - 40] - left) < 10).all()
        assert (np.abs(middle[300, centre + 40] - right) < 10).all()


def test_tab_takes_all_panels_away_and_the_picture_has_the_window(desk: DeskOffscreen) -> None:
    with_panels = shown(desk, view(), halves())
    assert share(part(with_panels, view(), "left"), ACCENT) > 0.002
    assert share(part(with_panels, view(), "right"), ACCENT) > 0.002
    bare = view(panels=False)
    pixels = shown(desk, bare)
    assert share(pixels, ACCENT) == 0
    assert share(pixels, LEFT_HALF) + share(pixels, RIGHT_HALF) == pytest.approx(SIZE[1] / SIZE[0], abs=0.02)


def test_what_is_transparent_shows_a_chequerboard(desk: DeskOffscreen) -> None:
    what = view()
    clear = np.zeros((64, 64, 4), np.uint8)
    middle = part(shown(desk, what, clear), what)
    centre = middle[250:450, 200:400]
    assert len(np.unique(centre.reshape(-1, 3), axis=0)) == 2


@pytest.mark.parametrize(
    ("what", "covered"),
    [
        (view(help=True), 0.5),
        (view(prompt=True), 0.05),
        (view(asking_reason=True), 0.05),
        (replace(view(curve=True), curve=Curve(np.array([1.0, 9]), np.array([1.0, 9]), np.array([30.0, 60]))), 0.1),
        (view(curve=True), 0.01),
    ],
    ids=["help", "prompt", "reason", "curve", "curve being measured"],
)
def test_cards_lie_in_the_middle_over_the_picture(desk: DeskOffscreen, what: DeskView, covered: float) -> None:
    white = np.full((64, 64, 3), 255, np.uint8)
    plain = part(shown(desk, view(), white), view())
    card = part(shown(desk, what), what)
    changed = np.abs(card - plain).max(-1) > 60
    assert changed.mean() > covered
    height, width = changed.shape
    assert changed[height // 2 - 20 : height // 2 + 20, width // 2 - 20 : width // 2 + 20].mean() > 0.5


def test_the_card_of_the_first_run_leaves_the_face_free(desk: DeskOffscreen) -> None:
    white = np.full((64, 64, 3), 255, np.uint8)
    plain = part(shown(desk, view(), white), view())
    what = view(welcome=True)
    changed = np.abs(part(shown(desk, what), what) - plain).max(-1) > 60
    height = len(changed)
    assert changed[int(0.85 * height) :].mean() > 0.1
    assert not changed[: int(0.8 * height)].any()  # a chin is there


PHASES = ["no source", "opening", "searching", "tracking", "hold", "idle", "stalled"]


@pytest.mark.parametrize("phase", PHASES)
def test_every_state_of_the_source_is_said_in_its_colour(desk: DeskOffscreen, phase: Any) -> None:
    what = replace(view(), health=Health(phase, "The camera is gone.", "Plug it in.", source="Camera"))
    silent = part(shown(desk, view(), halves()), what)
    pixels = shown(desk, what)
    assert (np.abs(part(pixels, what) - silent).max(-1) > 40).mean() > 0.01
    if phase == "stalled":
        assert share(part(pixels, what, "right"), np.array(theme.ALARM[:3]) * 255) > 0


def test_toasts_hints_outputs_countdown_and_menu_are_drawn(desk: DeskOffscreen) -> None:
    plain = shown(desk, view(), halves())
    rich = replace(
        view(resting=True, menu=True, exploring=Exploring(True, sigmas=(("position", 1, 2.0),))),
        toasts=(Toast("broken.gem is no avatar", alarm=True),),
        health=Health("tracking", hints=("It is dark: put a lamp in front of you.",)),
        outputs=(OutputLine("Recording", "12 s", failed=True),),
        rest=Rest(green=True, countdown=2.4, progress=0.5, score=0.1),
        loading="berta",
        cameras=("One", "Two"),
    )
    pixels = shown(desk, rich)
    for name in ("left", "right", "picture"):
        assert (np.abs(part(pixels, view(), name) - part(plain, view(), name)).max(-1) > 40).mean() > 0.01, name


def test_the_split_is_a_line_that_the_pointer_moves(desk: DeskOffscreen) -> None:
    what = view(compare=True, split=0.5)
    middle = part(shown(desk, what, halves()), what)
    column = middle.shape[1] // 2
    assert share(middle[:, column - 1 : column + 1], ACCENT) > 0.6
    area = laid_out(what, *SIZE).picture.fitted(64, 64)
    x, y = area.left + area.width / 2, area.top + 100
    for point in ((x, y, None), (x, y, True), (x + 0.25 * area.width, y, None), (x + 0.25 * area.width, y, False)):
        desk.point(*point)
        desk.show(None, what)
    splits = [order.value for order in desk.poll() if order.name == "split"]
    assert splits[-1] == pytest.approx(0.75, abs=0.01)


def test_dragging_turns_the_camera_the_wheel_zooms_and_panels_keep_the_pointer(desk: DeskOffscreen) -> None:
    what = view()
    shown(desk, what, halves())
    area = laid_out(what, *SIZE).picture
    x, y = area.left + 200, area.top + 200
    for point in ((x, y, None), (x, y, True), (x + 50, y, None), (x + 50, y, False)):
        desk.point(*point)
        desk.show(None, what)
    desk.scroll(1)
    desk.show(None, what)
    orders = desk.poll()
    turned = sum(float(order.value or 0) for order in orders if order.name == "yaw")
    assert turned == pytest.approx(15)
    assert [order for order in orders if order.name == "zoom"]
    for point in ((60, 400, True), (90, 420, None), (90, 420, False)):
        desk.point(*point)
        desk.show(None, what)
    assert not [order for order in desk.poll() if order.name in ("yaw", "pitch")]


def test_a_click_on_an_avatar_asks_for_it(desk: DeskOffscreen) -> None:
    what = view()
    shown(desk, what, halves())
    for point in ((90, 78, None), (90, 78, True), (90, 78, False)):
        desk.point(*point)
        desk.show(None, what)
        desk.show(None, what)
    assert Order("avatar", 2.0) in desk.poll()


def test_a_path_can_be_typed_and_its_letters_are_no_keys(desk: DeskOffscreen) -> None:
    what = view(prompt=True)
    shown(desk, what, halves())
    desk.type("film.mp4")
    desk.show(None, what)
    desk.press("M")
    assert desk.poll() == []
    desk.key("Enter")
    desk.show(None, what)
    desk.show(None, what)
    assert Order("open", "film.mp4") in desk.poll()


@pytest.mark.parametrize("card", [{"prompt": True}, {"asking_reason": True}, {"prompt": True, "help": True}])
def test_letters_belong_to_a_card_wherever_the_pointer_clicked(desk: DeskOffscreen, card: dict[str, bool]) -> None:
    """Else the letters of a path would record, open the camera and turn the avatar."""
    what = view(**card)
    area = laid_out(what, *SIZE).picture
    shown(desk, what, halves())
    x, y = area.left + 30, area.top + area.height - 30
    for point in ((x, y, None), (x, y, True), (x + 40, y, None), (x + 40, y, False)):
        desk.point(*point)
        desk.show(None, what)
    for letter in "RVC0P":
        desk.press(letter)
    assert desk.poll() == []
    desk.show(None, what)
    desk.type("long enough words to be a reason")
    desk.show(None, what)
    desk.key("Enter")
    for _ in range(2):
        desk.show(None, what)
    assert [order.value for order in desk.poll()] == ["long enough words to be a reason"]
    desk.press("Esc")
    assert [order.name for order in desk.poll()] == ["leave"]


def test_a_click_alone_turns_nothing(desk: DeskOffscreen) -> None:
    """Touch screens and remote desktops move the pointer and press it at once."""
    what = view()
    area = laid_out(what, *SIZE).picture
    shown(desk, what, halves())
    desk.point(10, 10)
    desk.show(None, what)
    desk.point(area.left + 200, area.top + 200, True)
    for _ in range(3):
        desk.show(None, what)
    assert desk.poll() == []


def test_panels_without_room_are_told_once_each_time(desk: DeskOffscreen) -> None:
    for what, orders in ((view(), 0), (view(ui_scale=2.5), 1), (view(ui_scale=2.5), 0), (view(), 0)):
        desk.show(halves(), what)
        assert desk.poll() == [Order("no_room")] * orders


@pytest.mark.parametrize("panels", [True, False])
def test_recording_is_seen_with_or_without_panels(desk: DeskOffscreen, panels: bool) -> None:
    what = view(panels=panels, record=True, figures=False)
    dot = share(shown(desk, what, halves()), np.array(theme.ALARM[:3]) * 255, within=6)
    assert (dot > 1e-4) is not panels


def test_the_menu_ticks_what_is_on() -> None:
    what = view(compare=True, off=frozenset(("scale",)), exploring=Exploring(on=True), no_badge="because of a test")
    on = {name for name in BY_NAME if is_on(what, name)}
    assert {"compare", "position", "explore", "mirror", "ladder", "loop"} <= on
    assert not {"scale", "sweep", "badge", "record", "quit", "zoom"} & on


def test_a_badge_is_left_out_only_with_a_reason(desk: DeskOffscreen) -> None:
    what = view(asking_reason=True)
    shown(desk, what, halves())
    why = "now it is a test of this"
    for words, orders in ((why[:2], []), (why[2:], [Order("badge", why)])):
        desk.show(None, what)
        desk.type(words)
        desk.show(None, what)
        desk.key("Enter")
        desk.show(None, what)
        desk.show(None, what)
        assert [order for order in desk.poll() if order.name == "badge"] == orders


def test_walking_by_keys_reaches_the_panels(desk: DeskOffscreen) -> None:
    what = view(walk=True)
    shown(desk, what, halves())
    for key in ("Down", "Down", "Enter"):
        desk.key(key)
        desk.show(None, what)
        desk.show(None, what)
    assert [order for order in desk.poll() if order.name in ("avatar", "open")]


def test_the_menu_is_walked_by_keys(desk: DeskOffscreen) -> None:
    what = view(menu=True)
    shown(desk, what, halves())
    for key in ("Down", "Right", "Down", "Enter"):
        desk.key(key)
        desk.show(None, what)
        desk.show(None, what)
    assert [order for order in desk.poll() if BY_NAME[order.name].menu == "Avatar"]


def test_larger_letters_and_small_windows_still_draw(desk: DeskOffscreen) -> None:
    for size, scale in (((360, 300), 1.0), ((1280, 800), 2.5), ((900, 500), 0.75)):
        desk.resize(size)
        what = view(ui_scale=scale, welcome=True)
        for _ in range(3):
            desk.show(halves(), what)
        pixels = desk.pixels()
        assert pixels.shape == (size[1], size[0], 3)
        assert share(pixels.astype(int), GROUND, 3) < 0.98


def test_the_sketch_is_drawn_and_a_click_on_it_follows_another_face(desk: DeskOffscreen) -> None:
    points = np.random.default_rng(0).uniform(0.3, 0.7, (478, 2)).astype(np.float32)
    shot = Shot(1, Pose(np.zeros(4, np.float32), NO_SHIFT), "", 0, 0, 0, sketch=points)
    without, what = view(), replace(view(), shot=shot)
    before = share(part(shown(desk, without, halves()), without, "right")[50:190], ACCENT, 60)
    assert share(part(shown(desk, what), what, "right")[50:190], ACCENT, 60) > before + 0.005
    x = SIZE[0] - 150
    for point in ((x, 120, None), (x, 120, True), (x, 120, False)):
        desk.point(*point)
        desk.show(None, what)
        desk.show(None, what)
    assert Order("relock") in desk.poll()
