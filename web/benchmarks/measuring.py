"""Scripts that measure within the page, and the work of its main thread."""

from playwright.sync_api import Page

NOTES = """
window.noted = [];
localStorage.setItem("microcosmos:tour-taken", "1");
new PerformanceObserver((list) => {
  for (const { name, entryType, startTime, duration } of list.getEntries())
    window.noted.push({ name, entryType, startTime, duration });
}).observe({ entryTypes: ["mark", "measure"] });
addEventListener("pointermove", ({ timeStamp }) => (window.moved = timeStamp), true);
"""
FRAMES = """
([seconds, moving]) => new Promise((resolve) => {
  const map = moving && document.querySelector("[role=application]");
  const { left, top, width, height } = map ? map.getBoundingClientRect() : {};
  const times = [];
  requestAnimationFrame(function step(now) {
    const turn = times.length / 40;
    const clientX = left + width * (0.5 + 0.4 * Math.cos(turn));
    const clientY = top + height * (0.5 + 0.4 * Math.sin(1.3 * turn));
    const event = { clientX, clientY, bubbles: true, pointerType: "mouse" };
    if (map) map.dispatchEvent(new PointerEvent("pointermove", event));
    times.push(now);
    if (now - times[0] < 1000 * seconds) requestAnimationFrame(step);
    else resolve(1000 * (times.length - 1) / (now - times[0]));
  });
})
"""
"""Frames per second over some seconds, with the pointer at another cell in each if it moves."""
BLOCKS = """
(side) => [...document.querySelectorAll("[data-gallery] canvas")].flatMap((canvas) => {
  const { width, height } = canvas;
  const copy = new OffscreenCanvas(width, height).getContext("2d");
  copy.drawImage(canvas, 0, 0);
  const words = [];
  for (let k = 0; k < side * side; k++) {
    const [x, y] = [(k % side) * width / side, Math.floor(k / side) * height / side];
    const { data } = copy.getImageData(x, y, width / side, height / side);
    let word = 0;
    for (let i = 0; i < data.length; i++) word = (31 * word + data[i]) | 0;
    words.push(word);
  }
  return words;
})
"""
"""A hash of each block of the gallery."""


def work_of_frames(page: Page, seconds: float, slower: float) -> tuple[float, float]:
    """Return milliseconds of the main thread for each frame, and frames per second.

    The processor is `slower` by this factor.
    """
    session = page.context.new_cdp_session(page)
    session.send("Performance.enable")
    session.send("Emulation.setCPUThrottlingRate", {"rate": slower})

    def busy() -> float:
        found = session.send("Performance.getMetrics")["metrics"]
        return next(one["value"] for one in found if one["name"] == "TaskDuration")

    before = busy()
    rate = page.evaluate(FRAMES, [seconds, False])
    return 1000 * (busy() - before) / (seconds * rate), rate
