//! Energy-minimal paths of a skid-steered robot: A* over (x, y, heading).
//!
//! States are cell centres with sixteen grid-aligned headings; motions are straights, arcs and point turns built
//! from the robot, each exact in its end pose. The energy of a motion integrates the power model along its own path
//! at its true radius and pitch. Regeneration makes some motions return energy; a potential proportional to height
//! makes every cost non-negative without changing the best path, so the search stays exact.
//!
//! Deterministic for any number of threads. No I/O, no async.
//!
//! Each uses only those above it:
//!
//! ```text
//! grid         headings, cells; states and costs packed into bits
//! error        why there is no path: errors and what hinders a robot (`hindrance`)
//! patience     how long a question may take
//! ground       height, attitude and clearance under the robot, outline, blocked cells
//! lattice      motions of a robot, what each takes on the ground, objectives
//! table        costs of all motions from every state, lower bounds of them
//! frontier     labels and queue of a search, Dijkstra's search
//! pose_field   least costs over poses: exact fields
//! field        least costs over cells to a goal, which lead A*
//! path         the path found: poses, totals, interval of its energy
//! search       A* over poses
//! refinement   the path freed from the lattice
//! question     ends, planner, plans, why there is none
//! ```

mod error;
mod field;
mod frontier;
mod grid;
mod ground;
mod hindrance;
mod lattice;
mod path;
mod patience;
mod pose_field;
mod question;
mod refinement;
mod search;
mod table;

pub use error::{Blocked, Error, Place};
pub use field::goal_field::{FieldEnds, GoalField};
pub use frontier::labels::Workspace;
pub use grid::{
    heading::{HEADINGS, Heading},
    state::State,
};
pub use ground::{clearance::Clearance, footprint::Footprint};
pub use hindrance::{Hindrance, Limit};
pub use lattice::{
    edge::Edge,
    graph::{Lattice, Settings, body_motion},
    ground_class::surface_names,
    objective::{Objective, Surcharge, Weights},
    prices::Prices,
    primitive::{Kind, Motion, Piece, motions},
    step::Step,
};
pub use path::{
    between::{Most, Stances, stances},
    coarse::{HiddenRelief, hidden_relief, is_coarse},
    room::least_room_m,
    route::{Pose, Route},
    stops::{stops, stops_j},
};
pub use patience::{Meter, Pacer, Patience, work};
pub use pose_field::exact::ExactField;
pub use question::{
    ends::Ends,
    plan::{compare, plan},
    planner::Planner,
    query::{Comparison, Goal, Plan, Query, SearchReport, Snap, Start},
    target::Target,
};
pub use refinement::refine::{Refined, RefinedPath, refine};
pub use search::astar::{Found, Outcome, Search, search};
pub use table::{cost_table::CostTable, relation::Relation, step_cost::StepCost};
