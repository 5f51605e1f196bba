//! Counts the outcomes of a suite's cases.

#[derive(Debug)]
pub enum Outcome {
    /// The program read the file, or answered the request, correctly.
    Right,
    Refused(String),
    /// Anything else: a crash, a hang, other numbers, or an answer to a request that needs none.
    Wrong(String),
}

#[derive(Debug, Default)]
pub struct Tally(pub Vec<(String, Outcome)>);

impl Tally {
    pub fn note(&mut self, case: impl Into<String>, outcome: Outcome) {
        self.0.push((case.into(), outcome));
    }

    pub fn wrong(&self) -> usize {
        self.count(|outcome| matches!(outcome, Outcome::Wrong(_)))
    }

    fn count(&self, is: impl Fn(&Outcome) -> bool) -> usize {
        self.0.iter().filter(|(_, outcome)| is(outcome)).count()
    }

    pub fn print(&self, part: &str, all: bool) {
        for (case, outcome) in &self.0 {
            match outcome {
                Outcome::Wrong(why) => println!("WRONG    {part}: {case}: {why}"),
                Outcome::Refused(why) if all => println!("refused  {part}: {case}: {why}"),
                Outcome::Right if all => println!("right    {part}: {case}"),
                _ => {}
            }
        }
        let right = self.count(|outcome| matches!(outcome, Outcome::Right));
        let refused = self.count(|outcome| matches!(outcome, Outcome::Refused(_)));
        println!(
            "{part:10} {:4} cases: {right} right, {refused} refused with a reason, {} wrong",
            self.0.len(),
            self.wrong()
        );
    }
}
