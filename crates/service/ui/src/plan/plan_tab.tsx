/** The Plan tab: the map, the answer, the question, the charts. */
import { isEditing, problem as areasProblem } from "../areas/state";
import { isWanted } from "../api/token";
import { AreaTools } from "../areas/tools";
import { MapView } from "../map/map_view";
import { ProblemCard } from "../widgets/problem_card";
import { Progress } from "../widgets/progress";
import { Warnings } from "../widgets/warnings";
import { Answer } from "./answer";
import { Charts } from "./charts";
import { Downloads } from "./downloads";
import { FirstMap } from "./first_map";
import { addMap, loadAll, loadProblem, sending } from "./load";
import { MapBar } from "./map_bar";
import { Relief3d } from "./relief_3d";
import { MissionAnswer } from "./mission_answer";
import { Question } from "./question";
import { RangeCard } from "./range_card";
import * as state from "./state";

export function PlanTab() {
  if (loadProblem.value && !state.maps.value) return <Unreachable />;
  const isEmpty = state.maps.value?.length === 0 || (state.maps.value !== null && !state.map.value);
  return (
    <div class="plan">
      <section class="plan-map" aria-label="Map" onDragOver={(event) => event.preventDefault()} onDrop={drop}>
        {!isEmpty && <MapBar />}
        {!isEmpty && isEditing.value && <AreaTools />}
        {areasProblem.value && <ProblemCard problem={areasProblem.value} close={() => (areasProblem.value = null)} />}
        {loadProblem.value && <ProblemCard problem={loadProblem.value} close={() => (loadProblem.value = null)} />}
        {sending.value !== null && <Progress label="Sending the map" share={sending.value < 1 ? sending.value : null} />}
        <Warnings label="Doubts about the map" list={state.map.value?.warnings ?? []} />
        {isEmpty ? <FirstMap /> : <Ground />}
      </section>
      {!isEmpty && (
        <aside class="plan-side" aria-label="Question and answer">
          {state.journey.value === "stops" ? <MissionAnswer /> : <Answer />}
          {state.journey.value === "goal" && <RangeCard />}
          <Question />
          <Downloads />
        </aside>
      )}
      {!isEmpty && <Charts />}
    </div>
  );
}

/** Without maps and robots there is nothing to show. Where a token is wanted, the form above asks for it. */
export function Unreachable() {
  if (isWanted.value) return null;
  return <div class="unreachable">{loadProblem.value && <ProblemCard problem={loadProblem.value} retry={loadAll} />}</div>;
}

/** A map's file may be dropped wherever the map is. */
function drop(event: DragEvent): void {
  const file = event.dataTransfer?.files[0];
  if (event.defaultPrevented || !file) return;
  event.preventDefault();
  void addMap(file);
}

function Ground() {
  const isWaiting = state.maps.value === null || (state.map.value !== null && state.cells.value === null && !loadProblem.value);
  return (
    <div class="plan-ground" aria-busy={isWaiting}>
      {state.is3d.value && state.cells.value ? <Relief3d /> : <MapView />}
      {isWaiting && !loadProblem.value && (
        <div class="map-waiting">
          <Progress label="Fetching the map" share={null} />
        </div>
      )}
    </div>
  );
}
