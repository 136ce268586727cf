//! Balls on a floor under a square light: what each pixel sees, and what reaches it from a point of the light.

pub const SIDE: usize = 256;
pub const PIXELS: usize = SIDE * SIDE;
/// A turn of the moving scene.
pub const PHASES: usize = 16;
const BALLS: usize = 4;

type Vector = [f32; 3];

fn add(a: Vector, b: Vector, scale: f32) -> Vector {
    [a[0] + scale * b[0], a[1] + scale * b[1], a[2] + scale * b[2]]
}

fn dot(a: Vector, b: Vector) -> f32 {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

/// Where a pixel's ray ends.
#[derive(Clone, Copy)]
pub struct Hit {
    point: Vector,
    normal: Vector,
    pub albedo: Vector,
    pub surface: u32,
}

pub const NOTHING: Hit = Hit { point: [0.0; 3], normal: [0.0; 3], albedo: [0.0; 3], surface: 0 };

/// Centre and radius.
#[derive(Clone, Copy)]
pub struct Ball(Vector, f32);

pub const NO_BALLS: [Ball; BALLS] = [Ball([0.0; 3], 0.0); BALLS];

/// The balls circle: phases are steps of a turn between two balls, which looks like a whole one.
pub fn balls(phase: usize) -> [Ball; BALLS] {
    let turn = phase as f32 / PHASES as f32;
    core::array::from_fn(|k| {
        let angle = (k as f32 + turn) * core::f32::consts::FRAC_PI_2;
        let (sine, cosine) = (libm::sinf(angle), libm::cosf(angle));
        Ball([1.5 * cosine, 0.55 + 0.25 * libm::sinf(2.0 * angle), 1.2 * sine], 0.5)
    })
}

/// Distance along a unit direction.
fn meet(Ball(centre, radius): Ball, from: Vector, direction: Vector) -> Option<f32> {
    let to = add(centre, from, -1.0);
    let along = dot(to, direction);
    let square = radius * radius - (dot(to, to) - along * along);
    (square > 0.0 && along > 0.0).then(|| along - libm::sqrtf(square)).filter(|&distance| distance > 1e-3)
}

fn unit(a: Vector) -> Vector {
    let scale = 1.0 / libm::sqrtf(dot(a, a));
    a.map(|value| value * scale)
}

pub fn first_hit(pixel: usize, balls: &[Ball; BALLS]) -> Hit {
    let across = ((pixel % SIDE) as f32 + 0.5) / SIDE as f32 - 0.5;
    let down = ((pixel / SIDE) as f32 + 0.5) / SIDE as f32 - 0.5;
    let eye = [0.0, 3.2, 5.2];
    let direction = unit([across * 0.9, -0.52 - down * 0.75, -0.85 + down * 0.46]);
    let mut nearest = (f32::MAX, NOTHING);
    for (k, &ball) in balls.iter().enumerate() {
        if let Some(distance) = meet(ball, eye, direction).filter(|&distance| distance < nearest.0) {
            let point = add(eye, direction, distance);
            let normal = unit(add(point, ball.0, -1.0));
            let albedo = [[0.9, 0.45, 0.3], [0.35, 0.6, 0.9], [0.5, 0.8, 0.4], [0.85, 0.75, 0.35]][k % 4];
            nearest = (distance, Hit { point, normal, albedo, surface: 2 + k as u32 });
        }
    }
    let floor = -eye[1] / direction[1];
    if floor < nearest.0 {
        let point = add(eye, direction, floor);
        let odd = (libm::floorf(point[0]) + libm::floorf(point[2])) as i32 & 1;
        nearest.1 = Hit { point, normal: [0.0, 1.0, 0.0], albedo: [[0.8; 3], [0.55; 3]][odd as usize], surface: 1 };
    }
    nearest.1
}

/// What arrives from point (u, v) of the light, over its density.
pub fn radiance(hit: &Hit, balls: &[Ball; BALLS], u: [f32; 2]) -> f32 {
    let light = [1.2 + 2.4 * (u[0] - 0.5), 3.6, -0.4 + 2.4 * (u[1] - 0.5)];
    let to = add(light, hit.point, -1.0);
    let square = dot(to, to);
    let distance = libm::sqrtf(square);
    let direction = to.map(|value| value / distance);
    let cosines = dot(hit.normal, direction) * direction[1];
    if cosines <= 0.0 || balls.iter().any(|&ball| meet(ball, hit.point, direction).is_some_and(|at| at < distance)) {
        return 0.0;
    }
    9.0 * cosines / square
}
