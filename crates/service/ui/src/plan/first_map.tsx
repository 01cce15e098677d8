/** What is there before any map is. */
import { GuideLink } from "../widgets/guide_link";
import { DropZone } from "../widgets/drop_zone";
import { addMap, addSample, sending } from "./load";
import { ReadingOptions } from "./reading_options";

export const MAP_ENDINGS = ".json,.asc,.txt,.tif,.tiff,.npy";

export function FirstMap() {
  return (
    <div class="first-map">
      <h2>Paths that cost the least energy</h2>
      <p>
        Give the ground, a start and a goal. joulepath finds the path that draws least from a skid-steered robot's battery, proves that none
        is cheaper, and shows it beside the shortest and the fastest.
      </p>
      <DropZone label="Drop a map here, or choose a file" accept={MAP_ENDINGS} take={(files) => files[0] && void addMap(files[0])}>
        <span>GeoTIFF, ESRI ASCII grid (.asc), a JSON grid, or a numpy array (.npy)</span>
      </DropZone>
      <p class="first-map-guide">
        <GuideLink chapter="maps">What maps may be like</GuideLink>
      </p>
      <ReadingOptions />
      <p class="first-map-or">
        <button type="button" class="primary" disabled={sending.value !== null} onClick={() => void addSample()}>
          Open the sample map
        </button>
        <span>400 m × 400 m of Minnesota, from lidar</span>
      </p>
    </div>
  );
}
