"""Store a map, plan over it, print the energy: python3 examples/plan.py MAP.tif [SERVICE]"""
import json, sys, urllib.request

def post(path, body, kind="application/json"):
    data = body if isinstance(body, bytes) else json.dumps(body).encode()
    return json.load(urllib.request.urlopen(urllib.request.Request(service + path, data, {"Content-Type": kind})))

service = sys.argv[2] if len(sys.argv) > 2 else "http://localhost:8080"
stored = post("/v1/maps", open(sys.argv[1], "rb").read(), "image/tiff")
x_m, y_m = stored["origin_m"]
question = {"map_id": stored["id"], "robot": "husky-a200-field", "start": {"x_m": x_m + 40, "y_m": y_m + 40}, "goal": {"x_m": x_m + 90, "y_m": y_m + 80}}
path = post("/v1/plan", question)
print(f"{path['energy_j'] / 1e3:.1f} kJ over {path['distance_m']:.0f} m, 95 % of {[round(j / 1e3, 1) for j in path['energy_interval_j']]} kJ")
