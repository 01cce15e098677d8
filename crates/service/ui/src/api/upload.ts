/** Files to the service, telling how far they are. `fetch` cannot tell that yet, the older request can. */
import { refused, unreachable } from "./problem";
import { authorization, noticed } from "./token";

/** Posts a body and reads JSON; `tell` hears the share sent, 0 to 1. */
export function upload<T>(path: string, body: Blob, contentType: string, tell: (share: number) => void): Promise<T> {
  return new Promise((resolve, reject) => {
    const request = new XMLHttpRequest();
    request.open("POST", path);
    request.setRequestHeader("content-type", contentType);
    request.setRequestHeader("accept", "application/json");
    for (const [name, value] of Object.entries(authorization())) request.setRequestHeader(name, value);
    request.upload.onprogress = (event) => event.lengthComputable && tell(event.loaded / event.total);
    request.onerror = () => reject(unreachable());
    request.onload = () => {
      noticed(request.status);
      if (request.status >= 200 && request.status < 300) resolve(JSON.parse(request.responseText) as T);
      else reject(refused(request.status, request.responseText));
    };
    request.send(body);
  });
}

/** The content type of numpy's arrays. */
export const ARRAY_TYPE = "application/x-npy";

/** The content type of a map file by its name. */
export function mapType(name: string): string {
  if (/\.tiff?$/i.test(name)) return "image/tiff";
  if (/\.npy$/i.test(name)) return ARRAY_TYPE;
  if (/\.json$/i.test(name)) return "application/json";
  return "text/plain";
}

/** The content type of a recording by its name. */
export function recordingType(name: string): string {
  if (/\.parquet$/i.test(name)) return "application/vnd.apache.parquet";
  if (/\.mcap$/i.test(name)) return "application/mcap";
  if (/\.db3$/i.test(name)) return "application/vnd.sqlite3";
  if (/\.bag$/i.test(name)) return "application/x-rosbag";
  return "text/csv";
}
