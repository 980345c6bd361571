/** A short tour: a panel beside the page explains its parts step by step. */

import { useEffect, useLayoutEffect, useRef, useState } from "preact/hooks";
import { useListener } from "../store/polling";
import { text } from "./text";
import { prefersReducedMotion } from "./canvas";
import "./tour.css";

export interface Step {
  title: string;
  text: string;
  /** Name of the part that the step explains, which is highlighted. */
  part: string;
  /** CSS selector of that part, which is scrolled into view. */
  selector: string;
}

interface Props {
  steps: Step[];
  /** True if the user started the tour; it then has the focus until it ends. */
  requested: boolean;
  onStep: (step: Step) => void;
  onEnd: () => void;
}

export function Tour({ steps, requested, onStep, onEnd }: Props) {
  const [number, setNumber] = useState(0);
  const panel = useRef<HTMLElement>(null);
  const step = steps[number]!;
  const last = number === steps.length - 1;
  useEffect(() => {
    onStep(step);
    scrollIntoWindow(document.querySelector(step.selector));
  }, [number]);
  useLayoutEffect(() => {
    if (!requested) return;
    const before = document.activeElement as HTMLElement | null;
    panel.current!.focus();
    return () => before?.focus();
  }, []);
  useListener("keydown", (event: KeyboardEvent) => {
    const typing = (event.target as Element).closest?.("input, select, textarea");
    if (event.key === "Escape" && !typing) onEnd();
  });
  return (
    <aside ref={panel} class="tour" aria-label={text.tour} tabIndex={-1}>
      <p class="tour-count quiet small">{text.step(number + 1, steps.length)}</p>
      <div aria-live="polite">
        <h2>{step.title}</h2>
        <p>{step.text}</p>
      </div>
      <p class="row">
        <button class="plain" onClick={onEnd}>
          {last ? text.close : text.skip}
        </button>
        <span class="spring" />
        {number > 0 && <button onClick={() => setNumber(number - 1)}>{text.back}</button>}
        <button class="primary" onClick={() => (last ? onEnd() : setNumber(number + 1))}>
          {last ? text.finish : text.next}
        </button>
      </p>
    </aside>
  );
}

/** Scroll to the middle of the window unless the whole element is visible above the panel. */
function scrollIntoWindow(element: Element | null): void {
  if (!element) return;
  const { top, bottom } = element.getBoundingClientRect();
  const visible = top >= 0 && bottom <= window.innerHeight;
  const behavior = prefersReducedMotion() ? "instant" : "smooth";
  if (!visible) element.scrollIntoView({ block: "center", behavior });
}
