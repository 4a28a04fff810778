//! Tests of the pictures by single pixels of them.

use nalgebra::Vector3;

use super::*;
use crate::figure::image::MAX_SIDE;
use crate::figure::layer::BACKGROUND;
use crate::geometry::Hull;

const SIZE: (u32, u32) = (120, 90);

fn view() -> View {
    View {
        eye: Point3::new(3.0, 0.0, 0.0),
        target: Point3::origin(),
        field_of_view: 0.7,
    }
}

fn ball(x: f64, radius: f64, color: Color) -> Solid {
    let pose = Isometry3::translation(x, 0.0, 0.0);
    Solid {
        shape: Shape::Sphere { radius },
        pose,
        color,
    }
}

fn hull(corners: &[[f64; 3]]) -> Shape {
    let corners: Vec<_> = corners.iter().copied().map(Point3::from).collect();
    Hull::new(&corners).unwrap().into()
}

fn wall(x: f64) -> Solid {
    let shape = Shape::Box {
        half_extents: Vector3::new(0.05, 1.0, 1.0),
    };
    Solid {
        shape,
        pose: Isometry3::translation(x, 0.0, 0.0),
        color: Color::BLUE,
    }
}

fn centre(image: &Image) -> [i32; 3] {
    image.pixel(SIZE.0 / 2, SIZE.1 / 2).unwrap().map(i32::from)
}

const RED: Color = Color::new(220, 30, 30);

fn is_red([red, green, blue]: [i32; 3]) -> bool {
    red > green + 60 && red > blue + 60
}

#[test]
fn every_shape_is_seen_in_its_colour_and_only_where_it_is() {
    let shapes = [
        Shape::Sphere { radius: 0.3 },
        Shape::Box {
            half_extents: Vector3::repeat(0.3),
        },
        Shape::Cylinder {
            radius: 0.3,
            length: 0.5,
        },
        Shape::Capsule {
            radius: 0.2,
            length: 0.3,
        },
        // A frustum beside its frame's origin.
        hull(&[
            [0.4, 0.4, -0.2],
            [0.4, -0.2, -0.2],
            [-0.2, 0.4, -0.2],
            [-0.2, -0.2, -0.2],
            [0.3, 0.3, 0.4],
            [0.3, -0.1, 0.4],
            [-0.1, 0.3, 0.4],
            [-0.1, -0.1, 0.4],
        ]),
        // Flat, and seen from no side edge on.
        hull(&[[-0.4, -0.4, 0.4], [0.4, -0.4, -0.4], [0.0, 0.4, 0.0]]),
    ];
    for shape in shapes {
        for turn in [0.0, 0.7, std::f64::consts::FRAC_PI_2] {
            let pose = Isometry3::rotation(turn * Vector3::y());
            let image = render(
                &view(),
                &[Solid {
                    shape: shape.clone(),
                    pose,
                    color: RED,
                }],
                &[],
                &[],
                SIZE,
            );
            let image = image.unwrap();
            assert!(
                is_red(centre(&image)),
                "{shape:?} {turn}: {:?}",
                centre(&image)
            );
            let corner = image.pixel(2, 2).unwrap();
            assert!(
                corner.iter().all(|&part| part > 225),
                "{shape:?}: {corner:?}"
            );
        }
    }
}

#[test]
fn a_ghost_behind_a_wall_is_invisible() {
    let ghost = vec![vec![ball(-1.0, 0.3, RED)]];
    let with = render(&view(), &[wall(0.0)], &ghost, &[], SIZE).unwrap();
    let without = render(&view(), &[wall(0.0)], &[], &[], SIZE).unwrap();
    assert_eq!(centre(&with), centre(&without));
    let before = vec![vec![ball(1.0, 0.3, RED)]];
    assert!(is_red(centre(
        &render(&view(), &[wall(0.0)], &before, &[], SIZE).unwrap()
    )));
}

#[test]
fn the_newest_ghost_is_opaque_and_the_oldest_nearly_transparent() {
    let scene = [wall(0.0)];
    let [old, new] = [
        vec![ball(1.0, 0.3, RED)],
        vec![ball(1.0, 0.3, Color::GREEN)],
    ];
    let both = render(&view(), &scene, &[old.clone(), new.clone()], &[], SIZE).unwrap();
    let one = render(&view(), &scene, &[new], &[], SIZE).unwrap();
    assert_eq!(centre(&both), centre(&one));
    let faint = render(&view(), &scene, &[old, vec![]], &[], SIZE).unwrap();
    let [red, _, blue] = centre(&faint);
    assert!(blue > red, "the wall must show through: {red} {blue}");
    assert_ne!(
        centre(&faint),
        centre(&render(&view(), &scene, &[], &[], SIZE).unwrap())
    );
}

#[test]
fn links_of_one_ghost_do_not_show_through_each_other() {
    let pair = vec![ball(1.0, 0.3, RED), ball(0.8, 0.3, Color::GREEN)];
    let twice = render(&view(), &[wall(0.0)], &[pair.clone(), vec![]], &[], SIZE).unwrap();
    let once = render(
        &view(),
        &[wall(0.0)],
        &[pair[..1].to_vec(), vec![]],
        &[],
        SIZE,
    )
    .unwrap();
    assert_eq!(centre(&twice), centre(&once));
}

#[test]
fn the_path_is_hidden_only_by_what_is_in_front_of_it() {
    let path = |x: f64| [Point3::new(x, -0.5, 0.0), Point3::new(x, 0.5, 0.0)];
    let plain = centre(&render(&view(), &[wall(0.0)], &[], &[], SIZE).unwrap());
    let before = centre(&render(&view(), &[wall(0.0)], &[], &path(1.0), SIZE).unwrap());
    let behind = centre(&render(&view(), &[wall(0.0)], &[], &path(-1.0), SIZE).unwrap());
    assert_eq!(behind, plain);
    assert_ne!(before, plain);
    let sight = |ball_at: f64, path: &[Point3<f64>]| {
        centre(&render(&view(), &[], &[vec![ball(ball_at, 0.2, RED)]], path, SIZE).unwrap())
    };
    assert_eq!(sight(1.5, &path(1.0)), sight(1.5, &[]));
    assert_ne!(sight(0.5, &path(1.0)), sight(0.5, &[]));
}

#[test]
fn impossible_input_is_an_error() {
    let bad = ball(f64::NAN, 0.3, RED);
    assert!(render(&view(), &[bad], &[], &[], SIZE).is_err());
    assert!(render(&view(), &[ball(0.0, 0.0, RED)], &[], &[], SIZE).is_err());
    assert!(render(&view(), &[], &[], &[Point3::new(0.0, f64::NAN, 0.0)], SIZE).is_err());
    assert!(
        render(
            &View {
                target: view().eye,
                ..view()
            },
            &[],
            &[],
            &[],
            SIZE
        )
        .is_err()
    );
    assert!(
        render(
            &View {
                field_of_view: 4.0,
                ..view()
            },
            &[],
            &[],
            &[],
            SIZE
        )
        .is_err()
    );
    assert!(render(&view(), &[], &[], &[], (0, 90)).is_err());
    assert!(render(&view(), &[], &[], &[], (MAX_SIDE + 1, 1)).is_err());
    let empty = render(&view(), &[], &[], &[Point3::origin()], (7, 5)).unwrap();
    assert_eq!(empty.pixel(0, 0), Some(BACKGROUND.map(|part| part as u8)));
}
