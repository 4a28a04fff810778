//! The parts of `table_arm`, each in the frame of its link.

use crate::loft::{Along, Part, Section, rectangle, round};

/// Sections whose widths grow ever slower or shrink ever faster make a convex body.
pub const PARTS: [Part; 13] = [
    Part {
        name: "base",
        along: Along::Z,
        corner_points: 4,
        sections: &[
            rectangle(0.0, [0.090, 0.090], 0.035),
            rectangle(0.006, [0.096, 0.096], 0.038),
            rectangle(0.028, [0.096, 0.096], 0.040),
            rectangle(0.120, [0.080, 0.080], 0.060),
            rectangle(0.150, [0.074, 0.074], 0.066),
            rectangle(0.160, [0.068, 0.068], 0.0665),
        ],
    },
    Part {
        name: "turret",
        along: Along::Z,
        corner_points: 5,
        sections: &[
            rectangle(0.004, [0.066, 0.066], 0.066),
            rectangle(0.012, [0.073, 0.073], 0.073),
            rectangle(0.060, [0.073, 0.073], 0.073),
            rectangle(0.100, [0.060, 0.050], 0.0495),
            rectangle(0.110, [0.050, 0.042], 0.0415),
        ],
    },
    Part {
        name: "shoulder",
        along: Along::Y,
        corner_points: 6,
        sections: &[
            round(-0.046, 0.060, [0.13, 0.0]),
            round(-0.040, 0.066, [0.13, 0.0]),
            round(0.030, 0.066, [0.13, 0.0]),
            round(0.050, 0.052, [0.13, 0.0]),
            round(0.056, 0.040, [0.13, 0.0]),
        ],
    },
    Part {
        name: "upper_arm",
        along: Along::Y,
        corner_points: 8,
        sections: &[
            plate(-0.118, [0.183, 0.048], 0.0475, [0.135, 0.0]),
            plate(-0.110, [0.193, 0.058], 0.0575, [0.135, 0.0]),
            plate(-0.062, [0.193, 0.058], 0.0575, [0.135, 0.0]),
            plate(-0.052, [0.185, 0.050], 0.0495, [0.135, 0.0]),
        ],
    },
    Part {
        name: "elbow",
        along: Along::Y,
        corner_points: 6,
        sections: &[
            round(-0.044, 0.050, [0.0; 2]),
            round(-0.038, 0.056, [0.0; 2]),
            round(0.030, 0.056, [0.0; 2]),
            round(0.048, 0.044, [0.0; 2]),
            round(0.052, 0.036, [0.0; 2]),
        ],
    },
    Part {
        name: "forearm",
        along: Along::X,
        corner_points: 5,
        sections: &[
            rectangle(0.020, [0.044, 0.044], 0.038),
            rectangle(0.030, [0.048, 0.048], 0.042),
            rectangle(0.120, [0.0445, 0.0445], 0.042),
            rectangle(0.152, [0.042, 0.042], 0.0415),
            rectangle(0.160, [0.037, 0.037], 0.0368),
        ],
    },
    Part {
        name: "wrist",
        along: Along::X,
        corner_points: 5,
        sections: &[
            round(0.004, 0.036, [0.0; 2]),
            round(0.010, 0.0405, [0.0; 2]),
            round(0.060, 0.0385, [0.0; 2]),
            round(0.098, 0.033, [0.0; 2]),
            round(0.106, 0.026, [0.0; 2]),
        ],
    },
    Part {
        name: "cheek",
        along: Along::Y,
        corner_points: 6,
        sections: &[
            plate(-0.058, [0.026, 0.056], 0.0255, [0.0, 0.108]),
            plate(-0.053, [0.030, 0.060], 0.0295, [0.0, 0.108]),
            plate(-0.040, [0.030, 0.060], 0.0295, [0.0, 0.108]),
            plate(-0.034, [0.027, 0.057], 0.0265, [0.0, 0.108]),
        ],
    },
    Part {
        name: "knuckle",
        along: Along::Y,
        corner_points: 6,
        sections: &[
            round(-0.030, 0.024, [0.0; 2]),
            round(-0.026, 0.029, [0.0; 2]),
            round(0.022, 0.029, [0.0; 2]),
            round(0.032, 0.020, [0.0; 2]),
        ],
    },
    Part {
        name: "neck",
        along: Along::X,
        corner_points: 5,
        sections: &[
            round(0.010, 0.020, [0.0; 2]),
            round(0.020, 0.026, [0.0; 2]),
            round(0.045, 0.026, [0.0; 2]),
            round(0.0585, 0.022, [0.0; 2]),
        ],
    },
    Part {
        name: "flange",
        along: Along::X,
        corner_points: 6,
        sections: &[
            round(0.001, 0.024, [0.0; 2]),
            round(0.004, 0.028, [0.0; 2]),
            round(0.018, 0.028, [0.0; 2]),
            round(0.024, 0.024, [0.0; 2]),
        ],
    },
    Part {
        name: "hand",
        along: Along::X,
        corner_points: 5,
        sections: &[
            rectangle(0.022, [0.011, 0.022], 0.0105),
            rectangle(0.045, [0.014, 0.040], 0.0130),
            rectangle(0.095, [0.0145, 0.044], 0.0140),
            rectangle(0.135, [0.012, 0.041], 0.0115),
            rectangle(0.165, [0.009, 0.034], 0.0085),
            rectangle(0.182, [0.005, 0.022], 0.0045),
        ],
    },
    Part {
        name: "thumb",
        along: Along::X,
        corner_points: 4,
        sections: &[
            plate(0.045, [0.0060, 0.0065], 0.0055, [0.0, -0.0470]),
            plate(0.060, [0.0085, 0.0100], 0.0080, [0.0, -0.0540]),
            plate(0.090, [0.0080, 0.0095], 0.0075, [0.0, -0.0615]),
            plate(0.112, [0.0050, 0.0060], 0.0045, [0.0, -0.0660]),
        ],
    },
];

/// A rounded rectangle beside the axis.
const fn plate(at: f64, half: [f64; 2], corner: f64, center: [f64; 2]) -> Section {
    Section {
        at,
        half,
        corner,
        center,
    }
}
