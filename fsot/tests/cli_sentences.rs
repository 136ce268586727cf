//! One of a thing is singular.

use crate::cli_support::{Place, error};

/// "1 steps": the first number that disagrees with its noun, in a line.
fn disagreement(text: &str) -> Option<String> {
    let plural = |word: &str| {
        let word = word.trim_end_matches([',', '.', ':', ';', ')']);
        word.ends_with('s') && !["class", "has"].contains(&word) && !word.starts_with('-')
    };
    text.lines().find_map(|line| {
        let words: Vec<&str> = line.split_whitespace().collect();
        let pair = words.windows(2).find(|pair| pair[0].trim_start_matches('(') == "1" && plural(pair[1]));
        pair.map(|pair| pair.join(" "))
    })
}

#[test]
fn one_is_singular() {
    let place = Place::new();
    place.write("one.txt", "0.5\n");
    place.write("pair.txt", "0.5 0.25\n0.75 0.5\n");
    place.write("ragged.json", r#"{"dims": 2, "points": [[1]]}"#);
    place.write("ragged.txt", "0.5 0.25\n0.75\n");
    image::GrayImage::from_pixel(1, 1, image::Luma([90])).save(place.path("in.png")).unwrap();
    for arguments in [
        "points -n 1 -d 1 --iterations 1 --out p.txt --threads 1",
        "points -n 1 --iterations 1 --out - --threads 1",
        "place -n 1 --iterations 1 --out o.csv",
        "place -n 1 --colors 2 --iterations 1 --out o.csv",
        "stipple in.png -n 1 --iterations 1 --out s.png",
        "stipple --frames in.png --window 1 --step 1 --iterations 1 --out s.png",
        "stipple --frames in.png --window 1 --step 1 -n 2 --out s.png",
        "tile --size 16 -d 1 --iterations 1 --integrands 1 --out t.nft",
        "tile --size 16 --temporal 2 --temporal-kernel ema:0.1 --out t.nft",
        "info",
        "info t.nft",
        "measure one.txt",
        "measure t.nft --integrands 1",
        "measure --prefix --integrands 1 pair.txt",
        "measure --size 3 pair.txt",
        "measure --size 3 one.txt",
        "measure ragged.json",
        "measure ragged.txt",
        "spectrum one.txt --out s.png",
    ] {
        let output = place.run(arguments);
        let said = String::from_utf8_lossy(&output.stdout).into_owned() + &error(&output);
        assert!(!said.contains("panicked"), "{arguments}: {said}");
        assert_eq!(disagreement(&said), None, "{arguments}: {said}");
    }
    assert_eq!(disagreement("of 1 steps, in all").as_deref(), Some("1 steps,"));
}

#[test]
fn numbers_agree_with_their_nouns() {
    let place = Place::new();
    let printed = place.succeed("points -n 1 --iterations 1 --out p.txt");
    assert!(printed.contains("  1 step in "), "{printed}");
    let printed = place.succeed("place -n 1 --iterations 1 --out o.csv");
    assert!(printed.starts_with("1 object, 1 colour: 1 class\n  1 step in "), "{printed}");
    let printed = place.succeed("place -n 4 --colors 2 --iterations 2 --out o.csv");
    assert!(printed.starts_with("4 objects, 2 colours: 3 classes\n  2 steps in "), "{printed}");
    let printed = place.succeed("tile --size 16 --spp 1 -d 1 --iterations 1 --integrands 1 --out t.nft");
    assert!(printed.contains("tile of 16x16 pixels, 1 sample of 1 dimension\n"), "{printed}");
    place.write("o.txt", "0.5 0.25\n");
    let printed = place.succeed("measure --prefix --integrands 1 o.txt");
    assert!(printed.contains("averaged over 1 set and 1 integrand of each family"), "{printed}");
}
