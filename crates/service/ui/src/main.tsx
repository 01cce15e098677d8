/** Puts the page together and starts it. */
import { render } from "preact";
import { App } from "./app";
import { listenForHelp } from "./help";
import { followAreas } from "./areas/changes";
import { isEditing } from "./areas/state";
import { followCalibration } from "./calibrate/state";
import { followDiagnosis } from "./diagnose/state";
import { followEarth } from "./map/earth";
import { keepLink, readLink } from "./plan/link";
import { listenForUndo } from "./plan/history";
import { followMap, isAllKnown, loadAll } from "./plan/load";
import { followMission } from "./plan/mission";
import { followReach } from "./plan/reach";
import { followQuestion } from "./plan/replan";
import "uplot/dist/uPlot.min.css";
import "./style/tokens.css";
import "./style/base.css";
import "./style/controls.css";
import "./style/map.css";
import "./style/areas.css";
import "./style/answer.css";
import "./style/plan.css";
import "./style/robots.css";
import "./style/diagnose.css";
import "./style/report.css";
import "./style/columns.css";

readLink();
followMap();
followAreas();
followEarth();
followQuestion();
followReach();
followMission();
followDiagnosis();
followCalibration();
keepLink();
listenForHelp();
listenForUndo(() => isEditing.value);
addEventListener("hashchange", () => {
  readLink();
  if (!isAllKnown()) void loadAll();
});
void loadAll();

const page = document.getElementById("page");
if (page) render(<App />, page);
