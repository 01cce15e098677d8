"""Uploads a map, plans on it and diagnoses a recording with the generated client: use.py URL MAP RECORDING."""

import json
import sys
from io import BytesIO
from pathlib import Path

from joulepath_client import Client
from joulepath_client.api.jobs import diagnose, read_job, read_job_events
from joulepath_client.api.maps import create_map
from joulepath_client.api.plan import plan
from joulepath_client.api.recordings import create_recording
from joulepath_client.models import DiagnoseRequest, MapFile, PlanAnswer, PlanRequest
from joulepath_client.types import File

url, map_file, recording_file = sys.argv[1:]
client = Client(base_url=url, raise_on_unexpected_status=True)

stored = create_map.sync(client=client, body=MapFile.from_dict(json.loads(Path(map_file).read_text())))
question = {
    "map_id": stored.id,
    "robot": "husky-a200",
    "start": {"x_m": 4, "y_m": 8},
    "goal": {"x_m": 20, "y_m": 12},
}
path = plan.sync(client=client, body=PlanRequest.from_dict(question))
assert isinstance(path, PlanAnswer), path
assert len(path.poses) > 1 and path.energy_j > 0

recording = create_recording.sync(client=client, body=File(payload=BytesIO(Path(recording_file).read_bytes())))
request = DiagnoseRequest.from_dict({"robot": "husky-a200", "recordings": [recording.id]})
started = diagnose.sync(client=client, body=request)
# The events end with the job.
read_job_events.sync_detailed(id=started.id, client=client)
job = read_job.sync(id=started.id, client=client)
assert str(job.state) == "done", job
print(f"Python: {path.energy_j:.0f} J over {path.distance_m:.1f} m, and a diagnosis")
