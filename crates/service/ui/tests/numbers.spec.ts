import { doubtsOf } from "../src/calibrate/doubts";
import { channelOf } from "../src/columns/channels";
import { guessAll, unitFor } from "../src/columns/guess";
import { mapOf, picksOf } from "../src/columns/recording_map";
import { quantity, sentence } from "../src/format";
import { columnsOf } from "../src/columns/table";
import { readNumber } from "../src/number";
import { joined } from "../src/plan/shown_paths";
import { eventsOf } from "../src/api/events";
import { poseAt } from "../src/map/along";
import { between, partsOf } from "../src/map/lattice";
import { northOf } from "../src/map/north";
import { roundLength_m, toMetres, toPixel, zoomed } from "../src/map/view";
import { energiesOf } from "../src/plan/reach";
import { arrivalCharge } from "../src/plan/charge";
import { readTyped } from "../src/plan/typed_place";
import type { Mission } from "../src/api/missions";
import type { Plan, Pose } from "../src/api/plans";
import type { Robot } from "../src/api/robots";
import { changed, read } from "../src/robots/pointer";
import { expect, test } from "./service";

const robot = { battery: { capacity_wh: 100, nominal_voltage_v: 24, reserve_fraction: 0.2 } } as Robot;

test("contours stand at round energies, and end at what the charge gives", () => {
  expect(energiesOf(robot, 1, 52_000)).toEqual([10_000, 20_000, 30_000, 40_000, 50_000, 60_000]);
  // 10 % above the reserve of 100 Wh are 36 kJ.
  expect(energiesOf(robot, 0.3, 52_000).at(-1)).toBeCloseTo(36_000, 6);
  expect(energiesOf(robot, 0.1, 52_000)).toEqual([]);
});

test("what arrives is the charge less the energy, with its interval", () => {
  const left = arrivalCharge({ energy_j: 36_000, energy_interval_j: [18_000, 54_000] } as unknown as Plan, robot, 0.5)!;
  expect([left.least, left.charge, left.greatest].map((charge) => Number(charge.toFixed(6)))).toEqual([0.35, 0.4, 0.45]);
});

test("a pose between two lies between them, and turns the short way", () => {
  const pose = (distance_m: number, heading_rad: number) =>
    ({ x_m: distance_m, y_m: 0, z_m: 0, t_s: 0, energy_j: 10 * distance_m, heading_rad, distance_m }) as Pose;
  const between = poseAt([pose(0, 3), pose(2, -3)], 1)!;
  expect([between.x_m, between.energy_j]).toEqual([1, 10]);
  expect(Math.abs(between.heading_rad)).toBeCloseTo(Math.PI, 6);
});

test("zooming keeps the place under the pointer, and pixels and metres are inverse", () => {
  const [view, size] = [
    { x_m: 50, y_m: 20, px_per_m: 4 },
    { width: 800, height: 600 },
  ];
  const map = { origin_m: [0, 0] as [number, number], columns: 200, rows: 100, cell_size_m: 1 };
  const about = { x: 123, y: 456 };
  const before = toMetres(view, size, about);
  const after = toMetres(zoomed(view, size, about, 1.7, map), size, about);
  expect(after.x_m).toBeCloseTo(before.x_m, 9);
  expect(after.y_m).toBeCloseTo(before.y_m, 9);
  expect(toPixel(view, size, before.x_m, before.y_m).x).toBeCloseTo(about.x, 9);
  expect(roundLength_m(view, 110)).toBe(20);
});

test("a field is changed by its pointer and nothing else is", () => {
  const before = { surfaces: { "wet/clay": { mu_roll: 0.1 } }, mechanisms: [{ parameters: { left_n: 1 } }] };
  const after = changed(changed(before, "/surfaces/wet~1clay/mu_roll", 0.2), "/mechanisms/0/parameters/left_n", 3);
  expect(read(after, "/surfaces/wet~1clay/mu_roll")).toBe(0.2);
  expect(after.mechanisms).toEqual([{ parameters: { left_n: 3 } }]);
  expect(before.surfaces["wet/clay"].mu_roll).toBe(0.1);
  expect(changed(before, "/surfaces", undefined)).toEqual({ mechanisms: before.mechanisms });
});

test("events are read whole, however the stream is cut", async () => {
  const text = 'event: progress\nid: 1\ndata: {"a":1}\n\n: alive\n\nid: 2\r\ndata: {\r\ndata: }\r\n\r\n';
  for (const length of [1, 3, 7, 1000]) {
    const bytes = new TextEncoder().encode(text);
    const stream = new ReadableStream<Uint8Array>({
      start(controller) {
        for (let at = 0; at < bytes.length; at += length) controller.enqueue(bytes.slice(at, at + length));
        controller.close();
      },
    });
    const events = [];
    for await (const event of eventsOf(stream)) events.push({ ...event });
    expect(events).toEqual([
      { id: "1", data: '{"a":1}' },
      { id: "2", data: "{\n}" },
    ]);
  }
});

test("places are read in every form, with decimal points and commas", () => {
  const read = (text: string) => {
    const { kind, pair, heading_deg } = readTyped(text);
    return [kind, ...pair, heading_deg];
  };
  expect(read("4, 8")).toEqual(["numbers", 4, 8, undefined]);
  expect(read("4,8,90")).toEqual(["numbers", 4, 8, 90]);
  expect(read("4,8, 5,2")).toEqual(["numbers", 4.8, 5.2, undefined]);
  expect(read("512030,5; 5422994,5; -90°")).toEqual(["numbers", 512030.5, 5422994.5, -90]);
  expect(read("512030,5 5422994,5")).toEqual(["numbers", 512030.5, 5422994.5, undefined]);
  expect(read("@0.2,0.8")).toEqual(["parts", 0.2, 0.8, undefined]);
  expect(read("46.5046N,93.9217W")).toEqual(["degrees", -93.9217, 46.5046, undefined]);
  expect(read("93,9217° w, 46,5046° n, 45°")).toEqual(["degrees", -93.9217, 46.5046, 45]);
  expect(read("46.5046, -93.9217")).toEqual(["numbers", 46.5046, -93.9217, undefined]);
  for (const [text, says] of [
    ["", "no place"],
    ["4", "no place"],
    ["4,8,5,2", "4 numbers"],
    ["4, 8,5", "two ways"],
    ["4,8 5", "two ways"],
    ["4, b", "no number"],
    ["4N, 5S", "one of E and W"],
    ["91N, 5E", "0 to 90"],
    ["4, 5, 400", "−360 to 360"],
    ["1.000,5; 2", "no number"],
  ] as const)
    expect(() => readTyped(text), text).toThrow(says);
});

test("a lattice gives the numbers between its nodes, and the way back", () => {
  const at = (u: number, v: number): [number, number] => [10 + 3 * u + 0.2 * u * v, 50 - 2 * v + 0.1 * u];
  const nodes = [0, 0.5, 1].flatMap((v) => [0, 0.5, 1].map((u) => at(u, v)));
  const lattice = { columns: 3, rows: 3, nodes };
  const [x, y] = between(lattice, [0.3, 0.8]);
  expect([x, y]).toEqual([expect.closeTo(at(0.3, 0.8)[0], 12), expect.closeTo(at(0.3, 0.8)[1], 12)]);
  const [u, v] = partsOf(lattice, [x, y]);
  expect([u, v]).toEqual([expect.closeTo(0.3, 9), expect.closeTo(0.8, 9)]);
});

test("the arrow shows true north where that is more than a degree off the grid", () => {
  const of = (turn_deg: number) => northOf(((90 - turn_deg) * Math.PI) / 180);
  expect(of(0.9)).toEqual({ turn_deg: 0, title: "Grid north, 0.9° from true north" });
  expect(of(2.1).turn_deg).toBeCloseTo(2.1, 9);
  expect(of(2.1).title).toBe("True north; the map's grid is turned 2.1° west of it");
  expect(of(-2.1).title).toContain("2.1° east");
  expect(northOf(null)).toEqual({ turn_deg: 0, title: "North by the map's y axis" });
});

test("columns are guessed by their names and sizes", () => {
  const text =
    '"Stamp (ns)","Left wheel","fr_rpm","Battery I [A]","Battery U [V]","IMU pitch","left_cmd","Note, again"\n' +
    '1764338400103108789,9.1,80,0.383,31.34,-4.5,1,"a ""b"", c"\n';
  const columns = columnsOf(text, false)!;
  expect(columns.at(-1)).toEqual({ name: "Note, again", cells: ['a "b", c'] });
  expect(guessAll(columns).map(({ channel, unit }) => [channel, unit])).toEqual([
    ["t_s", "ns"],
    ["v_left_mps", "rad/s"],
    ["v_right_mps", "rpm"],
    ["current_a", "A"],
    ["voltage_v", "V"],
    ["pitch_rad", "deg"],
    [null, ""],
    [null, ""],
  ]);
  const semicolons = columnsOf("t;v_left_mps;P_bat [kW]\n0,1;0,5;0,2\n0,2;0,5;0,2\n", true)!;
  expect(semicolons.map(({ cells }) => cells)).toEqual([["0,1"], ["0,5"], ["0,2"]]);
  expect(guessAll(semicolons).map(({ channel, unit }) => [channel, unit])).toEqual([
    ["t_s", "s"],
    ["v_left_mps", "m/s"],
    ["power_w", "kW"],
  ]);
  expect(columnsOf("nothing", false)).toBeNull();
});

test("a column's unit is what its name says, and time is a first column that rises where no name says time", () => {
  const rows = Array.from({ length: 12 }, (_, i) => `${i}${i ? ",5" : ""};1,5;12003;-0,1;${12 - i}`);
  const columns = columnsOf(`Zeit;Rad links km/h;Leistung (mW);Neigung (Grad);Rest\n${rows.join("\n")}\n`, false)!;
  expect(guessAll(columns).map(({ channel }) => channel)).toEqual(["t_s", null, null, null, null]);
  const unit = (at: number, channel: string) => unitFor(columns[at]!, channelOf(channel)!);
  expect([unit(1, "v_left_mps"), unit(2, "power_w"), unit(3, "pitch_rad"), unit(4, "power_w")]).toEqual(["km/h", "mW", "deg", "W"]);
  expect(
    guessAll([columns[4]!, columns[0]!]).map(({ channel }) => channel),
    "no first column that falls",
  ).toEqual([null, null]);
});

test("what was said of columns comes back from the map that it became", () => {
  const columns = columnsOf("a;b;c\n1;2;3\n", false)!;
  const picks = [
    { channel: "t_s", unit: "ms", isTurned: false },
    { channel: null, unit: "", isTurned: false },
    { channel: "power_w", unit: "W", isTurned: true },
  ];
  expect(picksOf(columns, mapOf(columns, picks, null, false))).toEqual(picks);
});

test("names lose their units, and sentences begin with a capital unless a name begins them", () => {
  expect(quantity("k1_w_per_n2", "W/N²")).toBe("k1");
  expect(quantity("motor_constant_per_k", "1/K")).toBe("motor constant");
  expect(quantity("resistance_per_k", "1/K")).toBe("resistance");
  expect(quantity("left_n", "N")).toBe("left");
  expect(quantity("mu_roll", "1")).toBe("mu roll");
  expect(sentence("no way leads there")).toBe("No way leads there.");
  expect(sentence("k1, k2 of `jackal` are borrowed")).toBe("k1, k2 of `jackal` are borrowed.");
  expect(sentence("mu_roll is borrowed.")).toBe("mu_roll is borrowed.");
});

test("a refusal names the doubts that may be overruled", () => {
  expect(doubtsOf("no robot was written; calibrate `--despite power_sign` `--despite held_out`")).toEqual(["power_sign", "held_out"]);
  expect(doubtsOf("there are no rows")).toEqual([]);
});

test("numbers are read with points, commas and any minus, and what can be read in two ways is none", () => {
  for (const [text, value] of [
    ["95,5", 95.5],
    [" 0.002 ", 0.002],
    ["−3", -3],
    [",5", 0.5],
    ["1e-3", 0.001],
  ] as const)
    expect(readNumber(text), text).toBe(value);
  for (const text of ["", "1.000,5", "1,000.5", "two", "5 m", "--2", "NaN", "Infinity"]) expect(readNumber(text), text).toBeNull();
});

test("the ways of a mission go on where the one before ends", () => {
  const way = (count: number) =>
    Array.from({ length: count }, (_, i) => ({ distance_m: 2 * i, energy_j: 10 * i, t_s: 4 * i, x_m: 0, y_m: 0, z_m: 0 }) as Pose);
  const stop = (poses: Pose[]) => ({ poses }) as Mission["stops"][number];
  const poses = joined({ stops: [stop([]), stop(way(3)), stop(way(2))] });
  expect(poses.map(({ distance_m }) => distance_m)).toEqual([0, 2, 4, 4, 6]);
  expect(poses.at(-1)).toMatchObject({ energy_j: 30, t_s: 12 });
});
