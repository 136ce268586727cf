//! Object placement: counts, evenness of every colour and size, files, bad input.

use crate::cli_support::Place;
use fsot::Error;
use fsot::metrics::neighbours::neighbours;
use fsot::optimize::{Quality, optimize};
use fsot::place::{Object, Options, Placement};
use fsot::points::Points;
use fsot::target::image::ImageTarget;

fn options(points: usize, colours: usize, sizes: bool) -> Options {
    Options { points, colours, sizes, map: None, seed: 3, quality: Quality::Iterations(500) }
}

fn objects(options: &Options) -> Vec<Object> {
    let placement = Placement::new(options).unwrap();
    placement.objects(&optimize(placement.problem.clone()).unwrap())
}

/// The mean distance to the nearest neighbour.
fn evenness(objects: &[Object]) -> f64 {
    neighbours(&Points::new(2, objects.iter().flat_map(|object| [object.x, object.y]).collect())).unwrap().mean
}

#[test]
fn every_colour_and_all_together_are_even() {
    let all = objects(&options(700, 7, false));
    assert!(evenness(&all) > 0.6, "{}", evenness(&all));
    for color in 0..7 {
        let own: Vec<Object> = all.iter().filter(|object| object.color == color).copied().collect();
        assert_eq!(own.len(), 100);
        assert!(evenness(&own) > 0.6, "colour {color}: {}", evenness(&own));
    }
    assert!(all.iter().all(|object| object.size == 0.5));
}

#[test]
fn the_larger_and_the_smaller_of_any_size_are_even() {
    let all = objects(&options(800, 1, true));
    for limit in [0.25, 0.5, 0.75] {
        let (small, large): (Vec<Object>, Vec<Object>) = all.iter().partition(|object| object.size < limit);
        assert_eq!(small.len(), (800.0 * limit) as usize);
        assert!(evenness(&small) > 0.6 && evenness(&large) > 0.6, "{} {}", evenness(&small), evenness(&large));
    }
}

#[test]
fn colours_and_sizes_together() {
    let options = options(101, 3, true);
    let placement = Placement::new(&options).unwrap();
    let names: Vec<&str> = placement.problem.classes.iter().map(|class| class.name.as_str()).collect();
    assert_eq!(names, ["colour 0", "colour 1", "colour 2", "all", "small", "large"]);
    let all = placement.objects(&Points::new(2, vec![0.5; 202]));
    let counts: Vec<usize> = (0..3).map(|color| all.iter().filter(|object| object.color == color).count()).collect();
    assert_eq!(counts, [34, 34, 33]);
    assert!(all.iter().all(|object| object.size > 0.0 && object.size < 1.0));
}

#[test]
fn a_map_says_where() {
    let map = ImageTarget::new(4, 2, &[1.0, 1.0, 0.0, 0.0, 1.0, 1.0, 0.0, 0.0], 300).unwrap();
    let all = objects(&Options { map: Some(map), ..options(300, 2, false) });
    assert!(all.iter().all(|object| object.x <= 0.505 && object.y <= 0.505));
}

#[test]
fn what_cannot_be_placed() {
    for (points, colours) in [(0, 1), (5, 0), (5, 6), (1000, 257)] {
        assert!(matches!(Placement::new(&options(points, colours, false)), Err(Error::Input(_))));
    }
}

#[test]
fn tables_and_pictures_are_written() {
    let place = Place::new();
    place.succeed("place -n 90 --colors 3 --iterations 10 -o a.csv --png a.png --svg a.svg");
    let text = |name: &str| String::from_utf8(place.read(name)).unwrap();
    assert_eq!(text("a.csv").lines().next(), Some("x,y,color,size"));
    assert_eq!(text("a.csv").lines().count(), 91);
    assert!(image::open(place.path("a.png")).is_ok());
    assert_eq!(text("a.svg").matches("<polygon").count(), 270);
    place.succeed("place -n 20 --sizes --iterations 5 -o a.json");
    let json: serde_json::Value = serde_json::from_str(&text("a.json")).unwrap();
    assert_eq!(json["objects"].as_array().unwrap().len(), 20);
    assert_eq!(json["colors"].as_array().unwrap().len(), 1);
    for (arguments, message) in [
        ("-n 2 --colors 3 -o b.csv", "2 objects cannot have 3 colours"),
        ("-n 5 -o b.txt", "b.txt is no name for a table"),
        ("-n 0 -o b.csv", "0 is not in"),
    ] {
        place.refuse(&format!("place {arguments}"), message);
    }
}
