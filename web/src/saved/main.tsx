/** A creature, or a motion alone, in one HTML file, which needs no server and no network. */

import { render } from "preact";
import "../ui/base.css";
import "../ui/parts.css";
import "../ui/tables.css";
import "../replay/replay.css";
import "../creature/creature.css";
import "../creature/details.css";
import "./saved.css";
import { decodeMotion } from "../decode/motion";
import { DATA, unpacked } from "../offline/packing";
import type { About } from "../offline/page";
import { SavedPage } from "./SavedPage";

const read = (id: string) => document.getElementById(id)!.textContent;
const about: About = JSON.parse(read(DATA.about));

void unpacked(read(DATA.motion)).then((motion) => {
  const readInputs = () => unpacked(read(DATA.evaluation));
  const replay = decodeMotion(motion);
  render(<SavedPage {...{ about, replay, readInputs }} />, document.getElementById("app")!);
});
