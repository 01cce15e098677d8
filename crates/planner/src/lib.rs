//! Energy-minimal paths of a skid-steered robot: A* over (x, y, heading).
//!
//! States are cell centres with sixteen grid-aligned headings; motions are straights, arcs and point turns built
//! from the robot, each exact in its end pose. The energy of a motion integrates the power model along its own path
//! at its true radius and pitch. Regeneration makes some motions return energy; a potential proportional to height
//! makes every cost non-negative without changing the best path, so the search stays exact.
//!
//! Deterministic for any number of threads. No I/O, no async.

mod along;
mod astar;

mod blocked;
mod changes;
mod changing;
mod clearance;
mod coarse;
mod connected;
mod connection;
mod cost;
mod course;
mod dijkstra;
mod displacement;
mod edge;
mod ends;
mod error;
mod exact;
mod exact_ends;
mod field;
mod fields;
mod footprint;
mod free;
mod front;
mod ground;
mod ground_class;
mod growth;
mod heading;
mod heights;
mod hindrance;
mod labels;
mod lattice;
mod layout;
mod least;
mod near;
mod noise;
mod objective;
mod partial;
mod patience;
mod piece_bound;
mod plan;
mod planner;
mod polish;
mod pose_codes;
mod pose_costs;
mod pose_growth;
mod pose_stencil;
mod pose_sweep;
mod prefetch;
mod preparation;
mod prices;
mod primitive;
mod proof;
mod query;
mod queue;
mod rates;
mod refine;
mod rings;
mod roll_bound;
mod room;
mod route;
mod row_step;
mod shortcut;
mod snap;
mod spans;
mod stance;
mod stencil;
mod step;
mod step_costs;
mod stops;
mod sweep;
mod swept;
mod table;
mod target;
mod tile;
mod tile_bound;
mod tile_builder;
mod uncertainty;
mod unlimited;
mod walk_back;
mod window;

pub use astar::{Found, Outcome, Search, search};
pub use clearance::Clearance;
pub use coarse::is_coarse;
pub use edge::Edge;
pub use ends::Ends;
pub use error::{Blocked, Error, Place};
pub use exact::ExactField;
pub use field::{FieldEnds, GoalField};
pub use footprint::Footprint;
pub use heading::{HEADINGS, Heading};
pub use hindrance::{Hindrance, Limit};
pub use labels::Workspace;
pub use lattice::{Lattice, Settings, State, body_motion};
pub use objective::{Objective, Surcharge, Weights};
pub use patience::{Meter, Pacer, Patience, work};
pub use plan::{compare, plan};
pub use planner::{Planner, surface_names};
pub use prices::Prices;
pub use primitive::{Kind, Motion, Piece, motions};
pub use query::{Comparison, Goal, Plan, Query, SearchReport, Snap, Start};
pub use refine::{Refined, refine};
pub use room::least_room_m;
pub use route::{Pose, Route};
pub use step::Step;
pub use stops::{stops, stops_j};
pub use table::{CostTable, StepCost};
pub use target::Target;
