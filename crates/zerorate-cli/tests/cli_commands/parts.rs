//! The catalogue of parts.

use super::zerorate;

#[test]
fn every_part_of_the_list_can_be_printed_and_used() {
    let list = zerorate(&["parts"]).ended_with(0).stdout;
    assert!(list.starts_with("part ") && list.contains("ADIS16130 ") && list.contains("±250 to 2000 °/s"), "{list}");
    let json = zerorate(&["parts", "--json"]).ended_with(0).stdout;
    let json: serde_json::Value = serde_json::from_str(&json).expect("JSON");
    let names: Vec<&str> =
        json["parts"].as_array().unwrap().iter().map(|part| part["name"].as_str().unwrap()).collect();
    assert!(names.len() >= 20, "{names:?}");
    for name in names {
        assert!(list.contains(&format!("\n{name} ")), "{name} in\n{list}");
        let file = zerorate(&["parts", name]).ended_with(0).stdout;
        assert!(file.contains(&format!("name = {name:?}")) && file.contains("source = "), "{file}");
    }
}

#[test]
fn a_name_is_found_as_people_write_it() {
    let file = zerorate(&["parts", "ICM-20948"]).ended_with(0).stdout;
    for name in ["icm20948", "icm_20948", "ICM20948"] {
        assert_eq!(zerorate(&["parts", name]).ended_with(0).stdout, file);
    }
    zerorate(&["parts", "20948"]).ended_with(2).saying(&["did you mean icm20948?", "`zerorate parts` lists"]);
    zerorate(&["parts", "nobody"]).ended_with(2).saying(&["nobody is neither a file nor a known part: `zerorate"]);
    let wrong = ["capture", "--device", "twin:", "--part", "icm20948:300", "-o", "never.csv"];
    zerorate(&wrong).ended_with(2).saying(&["no full scale of 300 °/s; it has: 250, 500, 1000, 2000"]);
    let other = ["capture", "--device", "twin:", "--part", "20948", "-o", "never.csv"];
    zerorate(&other).ended_with(2).saying(&["--part 20948: ", "did you mean icm20948?"]);
}
