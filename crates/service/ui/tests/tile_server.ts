/** A server of tiles on this machine: green ground with a red dot at every place that it is told of. */
import { createServer, type Server } from "node:http";
import type { AddressInfo } from "node:net";
import { deflateSync } from "node:zlib";

const EDGE_PX = 256;

/** The checksum of PNG (ISO 15948, annex D). */
function crc(bytes: Buffer): number {
  let value = ~0;
  for (const byte of bytes) {
    value ^= byte;
    for (let bit = 0; bit < 8; bit++) value = value & 1 ? (value >>> 1) ^ 0xedb88320 : value >>> 1;
  }
  return ~value >>> 0;
}

function chunk(kind: string, body: Buffer): Buffer {
  const typed = Buffer.concat([Buffer.from(kind), body]);
  const [length, sum] = [Buffer.alloc(4), Buffer.alloc(4)];
  length.writeUInt32BE(body.length);
  sum.writeUInt32BE(crc(typed));
  return Buffer.concat([length, typed, sum]);
}

function png(colorAt: (x: number, y: number) => [number, number, number]): Buffer {
  const rows = Buffer.alloc(EDGE_PX * (3 * EDGE_PX + 1));
  for (let y = 0; y < EDGE_PX; y++)
    for (let x = 0; x < EDGE_PX; x++) rows.set(colorAt(x + 0.5, y + 0.5), y * (3 * EDGE_PX + 1) + 1 + 3 * x);
  const head = Buffer.alloc(13);
  head.writeUInt32BE(EDGE_PX, 0);
  head.writeUInt32BE(EDGE_PX, 4);
  head.set([8, 2], 8);
  const signature = Buffer.from([0x89, 0x50, 0x4e, 0x47, 0x0d, 0x0a, 0x1a, 0x0a]);
  return Buffer.concat([signature, chunk("IHDR", head), chunk("IDAT", deflateSync(rows)), chunk("IEND", Buffer.alloc(0))]);
}

/** Pixels of the whole world at a zoom: spherical Mercator (EPSG:3857). */
function worldPixel(lon_deg: number, lat_deg: number, z: number): [number, number] {
  const edge = EDGE_PX * 2 ** z;
  const lat_rad = (lat_deg * Math.PI) / 180;
  return [(lon_deg / 360 + 0.5) * edge, (0.5 - Math.log(Math.tan(Math.PI / 4 + lat_rad / 2)) / (2 * Math.PI)) * edge];
}

/** Starts a server with dots at places, by longitude and latitude. Returns its template and what it was asked for. */
export async function serveTiles(places_deg: [number, number][]): Promise<{ url: string; asked: string[]; server: Server }> {
  const asked: string[] = [];
  const server = createServer((request, response) => {
    asked.push(request.url ?? "");
    const [z = 0, x = 0, y = 0] = (/(\d+)\/(\d+)\/(\d+)\.png$/.exec(request.url ?? "") ?? []).slice(1).map(Number);
    const dots = places_deg.map(([lon_deg, lat_deg]) => worldPixel(lon_deg, lat_deg, z));
    const isDot = (px: number, py: number) => dots.some(([dx, dy]) => Math.hypot(x * EDGE_PX + px - dx, y * EDGE_PX + py - dy) < 4);
    response.setHeader("content-type", "image/png");
    response.end(png((px, py) => (isDot(px, py) ? [255, 0, 0] : [0, 160, 0])));
  });
  await new Promise<void>((resolve) => server.listen(0, "127.0.0.1", resolve));
  const { port } = server.address() as AddressInfo;
  return { url: `http://127.0.0.1:${port}/{z}/{x}/{y}.png`, asked, server };
}
