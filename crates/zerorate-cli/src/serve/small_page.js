// Updates the numbers in place, so that a selection stays and a server that starts again is found.
const numbers = document.querySelector("pre");

async function read() {
  const answer = await fetch("/");
  const page = new DOMParser().parseFromString(await answer.text(), "text/html");
  return page.querySelector("pre")?.textContent ?? "The program does not show its numbers.";
}

async function show() {
  const text = await read().catch(() => "The program does not answer.");
  if (numbers.textContent !== text) numbers.textContent = text;
  setTimeout(show, 1000);
}

setTimeout(show, 1000);
