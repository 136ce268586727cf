//! index.html: what to look at first, and everything else that was written.

/// The three pictures to open, and what they show.
const FIRST: [(&str, &str); 3] = [
    ("shared.png", "Samplers and shared fits at equal samples: each image with its error below"),
    ("global-comparison.png", "Three bounces: the plain mean and fits to each pixel's own samples"),
    ("training-image.png", "A photograph learned from uniform and from weighted minibatches"),
];

/// Parts and their files.
#[derive(Default)]
pub(super) struct Pages(Vec<(String, Vec<String>)>);

impl Pages {
    pub(super) fn add(&mut self, title: &str, files: Vec<String>) {
        self.0.push((title.to_owned(), files));
    }

    pub(super) fn html(&self) -> String {
        let mut html = String::from("<!doctype html><meta charset=\"utf-8\"><title>noisefloor: demo</title>\n");
        html += "<style>body{font-family:sans-serif;max-width:70em;margin:2em auto} img{max-width:100%}</style>\n";
        html += "<h1>noisefloor: demo</h1>\n";
        let has = |name: &str| self.0.iter().any(|(_, files)| files.iter().any(|file| file == name));
        for (name, shows) in FIRST.into_iter().filter(|(name, _)| has(name)) {
            html += &format!("<h2>{shows}</h2>\n<a href=\"{name}\"><img src=\"{name}\" alt=\"{shows}\"></a>\n");
        }
        for (title, files) in &self.0 {
            html += &format!("<h2>{title}: all files</h2>\n<ul>\n");
            for file in files {
                html += &format!("<li><a href=\"{file}\">{file}</a></li>\n");
            }
            html += "</ul>\n";
        }
        html
    }
}

#[cfg(test)]
mod tests {
    use super::Pages;

    #[test]
    fn pictures_that_were_made_come_first() {
        let mut pages = Pages::default();
        pages.add("Trainers", vec!["a.csv".to_owned(), "training-image.png".to_owned()]);
        let html = pages.html();
        assert!(html.find("<img src=\"training-image.png\"") < html.find("a.csv"));
        assert!(!html.contains("shared.png"));
    }
}
