//! What comes from outside cannot drive the terminal, whatever command prints it.

use std::fs;

use etendue::{FilmRecord, SumsFile};

use crate::run::{Outcome, Workplace, small_scene};

/// A name with an escape sequence, a line that looks like a message, a C1 control character and marks
/// that reverse the direction of writing.
const NAME: &str = "a\u{1b}[2J\nerror: all files deleted\u{9b}31m\u{202e}b\u{2069}";

/// Every command with arguments that name hostile files.
fn commands() -> Vec<(&'static str, Vec<String>)> {
    let name = |extension: &str| format!("{NAME}.{extension}");
    let arguments = |list: &[&str]| -> Vec<String> { list.iter().map(|a| (*a).into()).collect() };
    vec![
        ("render", arguments(&["render", &name("xml"), "-o", "x.exr"])),
        ("render", arguments(&["render", &small_scene(), "-o", &name("exr"), "--spp", "1"])),
        ("render", arguments(&["render", &small_scene(), "-o", &name("nothing")])),
        ("render", arguments(&["render", &small_scene(), "--sensor", NAME])),
        ("render", arguments(&["render", &small_scene(), "--spp", NAME])),
        ("render", arguments(&["render", &small_scene(), "--json-progress", "-o", &name("exr")])),
        ("check", arguments(&["check", &name("xml")])),
        ("check", arguments(&["check", &name("xml"), "--verbose"])),
        ("check", arguments(&["check", &name("missing")])),
        ("check", arguments(&["check", &small_scene(), "-D", &format!("{NAME}=1")])),
        ("info", arguments(&["info", &name("xml")])),
        ("info", arguments(&["info", "names.xml"])),
        ("info", arguments(&["info", "names.xml", "--json"])),
        ("merge", arguments(&["merge", "forged.part", "other.part", "-o", "x.exr"])),
        ("merge", arguments(&["merge", &name("part"), "-o", "x.exr"])),
        ("diff", arguments(&["diff", &name("png"), "x.exr"])),
        ("diff", arguments(&["diff", "x.exr", "x.exr", "--variance", &name("exr")])),
        ("convert", arguments(&["convert", &name("png"), "x.exr"])),
        ("convert", arguments(&["convert", &name("png"), &name("nothing")])),
        ("completions", arguments(&["completions", NAME])),
        ("completions", arguments(&["completions", "fish"])),
        ("man", arguments(&["man", NAME])),
        ("man", arguments(&["man"])),
    ]
}

/// Scenes and parts that hold hostile names.
fn prepare(workplace: &Workplace) {
    let escaped = NAME.replace('\u{1b}', "").replace('\n', "&#10;");
    let problems = format!(
        "<scene version=\"3.0.0\"><default name=\"a\" value=\"1\"/><integrator type=\"{escaped}\"/>\
         <include filename=\"{escaped}.xml\"/><shape type=\"{escaped}\"/>{}\
         <bsdf type=\"diffuse\" id=\"{escaped}\"><float name=\"{escaped}\" value=\"x\"/></bsdf>\
         </scene>",
        format!("<shape type=\"ply\"><string name=\"filename\" value=\"{escaped}\"/></shape>")
            .repeat(9)
    );
    fs::write(workplace.path(&format!("{NAME}.xml")), problems).unwrap();
    fs::write(workplace.path(&format!("{NAME}.png")), "no picture").unwrap();
    fs::write(workplace.path(&format!("{NAME}.part")), "no part").unwrap();
    let names = format!(
        "<scene version=\"3.0.0\"><sensor type=\"perspective\" id=\"{escaped}\"/>\
         <emitter type=\"constant\"/><shape type=\"sphere\"/></scene>"
    );
    fs::write(workplace.path("names.xml"), names).unwrap();
    let scene = small_scene();
    workplace.succeed(&["render", &scene, "-q", "--samples", "1/2", "-o", "other.part"]);
    workplace.succeed(&["render", &scene, "-q", "--samples", "2/2", "-o", "forged.part"]);
    let forged = SumsFile::new(workplace.path("forged.part"));
    let (file, film) = forged.read(1 << 30).unwrap();
    let mut record: FilmRecord = file.record;
    record.identity.push((NAME.to_owned(), NAME.to_owned()));
    forged.write(&film, &record).unwrap();
}

fn check(arguments: &[String], outcome: &Outcome) {
    for text in [&outcome.stdout, &outcome.stderr] {
        let acts = |c: char| (c.is_control() && c != '\n') || "\u{202e}\u{2069}".contains(c);
        assert!(!text.contains(acts), "{arguments:?}: {text:?}");
        let forged = text.lines().any(|line| line.starts_with("error: all files deleted"));
        assert!(!forged, "{arguments:?}: {text}");
    }
}

#[test]
fn no_command_prints_control_characters_of_others() {
    let workplace = Workplace::new();
    prepare(&workplace);
    let help = workplace.succeed(&["--help"]).stdout;
    let list = help.split("Commands:").nth(1).unwrap().split("\n\n").next().unwrap();
    let tried = commands();
    for command in list.lines().filter_map(|line| line.split_whitespace().next()) {
        let is_tried = tried.iter().any(|(name, _)| *name == command);
        assert!(is_tried || command == "help", "add a case for `{command}`");
    }
    for (_, arguments) in &tried {
        let arguments: Vec<&str> = arguments.iter().map(String::as_str).collect();
        let outcome = workplace.run(&arguments);
        let owned: Vec<String> = arguments.iter().map(|a| (*a).to_owned()).collect();
        check(&owned, &outcome);
    }
}

#[test]
fn json_is_valid_where_names_are_hostile() {
    let workplace = Workplace::new();
    prepare(&workplace);
    let shown = workplace.succeed(&["info", "names.xml", "--json"]).stdout;
    let value: serde_json::Value = serde_json::from_str(&shown).unwrap();
    assert!(value["sensors"][0]["id"].as_str().unwrap().contains('\u{9b}'));
}

#[test]
fn other_locales_than_utf8_get_ascii() {
    let workplace = Workplace::new();
    fs::write(workplace.path("a.xml"), "<scene version=\"3.0.0\"><shape type=\"x\"/></scene>")
        .unwrap();
    let run = |locale: &str| -> Outcome {
        let mut command = workplace.command(&["check", "a.xml"]);
        command.env_remove("LC_ALL").env_remove("LC_CTYPE").env("LANG", locale);
        command.output().unwrap().into()
    };
    assert!(run("C").stderr.contains("--> a.xml:1:"));
    assert!(run("de_DE.UTF-8").stderr.contains("┌─ a.xml:1:"));
}
