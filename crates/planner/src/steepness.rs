//! How steep the ground is about a row of cells, and whether it is all of one kind.

use crate::{
    layout::TILE,
    tile_builder::{GROUPS, LANES},
    window::Window,
};

/// What the ground within reach of each group of cells of a tile is like.
pub(crate) struct Steepness {
    groups: Vec<[Surroundings; GROUPS]>,
}

/// The ground within reach of a group of cells.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Surroundings {
    /// Steepest grade, of the ground or of the plane on which the robot stands; infinite where it cannot stand on known ground.
    pub(crate) steepest: f32,
    /// Kind of ground; `None` where there are several.
    pub(crate) class: Option<u8>,
}

/// By cell of a window: what the maximum is taken of.
struct Layers {
    /// Square of the gradient under the wheels, in any orientation.
    squared: Vec<f32>,
    /// Grade to the next cell east, and north.
    east: Vec<f32>,
    north: Vec<f32>,
}

impl Steepness {
    /// Of a tile, within the halo of a window.
    pub(crate) fn new(window: &Window, cell_size_m: f32) -> Self {
        let layers = Layers::new(window, cell_size_m);
        let groups = (0..TILE).map(|row| of_row(window, &layers, row)).collect();
        Steepness { groups }
    }

    /// By group of a row of the tile.
    pub(crate) fn row(&self, row: usize) -> &[Surroundings; GROUPS] {
        &self.groups[row]
    }
}

impl Layers {
    fn new(window: &Window, cell_size_m: f32) -> Self {
        let (width, height_m) = (window.width(), &window.height_m);
        let mut layers = Layers {
            squared: vec![0.0; height_m.len()],
            east: vec![0.0; height_m.len()],
            north: vec![0.0; height_m.len()],
        };
        for [east, north] in &window.gradients {
            for (squared, (east, north)) in layers.squared.iter_mut().zip(east.iter().zip(north)) {
                let own = east * east + north * north;
                // A comparison that is true of ground that the body would touch.
                *squared = if own <= *squared {
                    *squared
                } else if own.is_nan() {
                    f32::INFINITY
                } else {
                    own
                };
            }
        }
        for (squared, height_m) in layers.squared.iter_mut().zip(height_m) {
            // No motion that may be driven reads unknown ground.
            *squared = if height_m.is_nan() { 0.0 } else { *squared };
        }
        let grade = |a: f32, b: f32| {
            let grade = (b - a).abs() / cell_size_m;
            if grade.is_nan() { 0.0 } else { grade }
        };
        for (out, pair) in layers.east.iter_mut().zip(height_m.windows(2)) {
            *out = grade(pair[0], pair[1]);
        }
        for (out, (south, north)) in
            layers.north.iter_mut().zip(height_m.iter().zip(height_m.iter().skip(width)))
        {
            *out = grade(*south, *north);
        }
        layers
    }
}

/// The surroundings of a row's groups: maxima down the columns of the window within reach, then along them.
fn of_row(window: &Window, layers: &Layers, row: usize) -> [Surroundings; GROUPS] {
    let (width, reach) = (window.width(), window.halo());
    let rows = row * width..(row + 2 * reach + 1) * width;
    let [squared, east, north] =
        [&layers.squared, &layers.east, &layers.north].map(|layer| down(&layer[rows.clone()], width));
    let mut classes = vec![[u8::MAX, 0]; width];
    if window.present.len() > 1 {
        for cells in window.class[rows].chunks_exact(width) {
            for ([low, high], class) in classes.iter_mut().zip(cells) {
                (*low, *high) = ((*low).min(*class), (*high).max(*class));
            }
        }
    }
    std::array::from_fn(|group| {
        let columns = group * LANES..(group + 1) * LANES + 2 * reach;
        let most =
            |values: &[f32]| values[columns.clone()].iter().fold(0.0f32, |most, value| most.max(*value));
        let steepest = most(&squared).sqrt().max(most(&east).hypot(most(&north)));
        let class = match window.present[..] {
            [only] => Some(only),
            _ => {
                let low = classes[columns.clone()].iter().map(|[low, _]| *low).min();
                let high = classes[columns.clone()].iter().map(|[_, high]| *high).max();
                low.filter(|_| low == high)
            }
        };
        Surroundings { steepest, class }
    })
}

/// The largest value of each column.
fn down(layer: &[f32], width: usize) -> Vec<f32> {
    let mut most = vec![0.0f32; width];
    for row in layer.chunks_exact(width) {
        for (most, value) in most.iter_mut().zip(row) {
            *most = if *value > *most { *value } else { *most };
        }
    }
    most
}
