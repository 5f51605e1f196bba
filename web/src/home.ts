/** Where the page comes from: a static site, or `zerorate serve` (docs/formats/page.md). */
export type Home = { home: "static" } | { home: "served"; token_needed: boolean };

export async function home(): Promise<Home> {
  const answer = await fetch("home.json", { cache: "no-store" });
  if (!answer.ok) throw new Error(`home.json: ${answer.status}`);
  return (await answer.json()) as Home;
}
