// The static page works without a network after its first visit. `zerorate serve` has no service worker, which would
// show an old page.

declare const FILES: string[];
/** Files that are cached when they are first used, with their SHA-256. */
declare const LATER: Record<string, string>;
declare const VERSION: string;

const scope = self as unknown as ServiceWorkerGlobalScope;
/** Start of the names of this page's caches. Other pages of the same site have caches with other names. */
const PREFIX = "zerorate-";
const CACHE = PREFIX + VERSION;

async function install(): Promise<void> {
  const cache = await caches.open(CACHE);
  // bypass the browser's own cache, which may still have the previous version
  await cache.addAll(FILES.map((file) => new Request(file, { cache: "reload" })));
  await scope.skipWaiting();
}

async function activate(): Promise<void> {
  const old = (await caches.keys()).filter((name) => name.startsWith(PREFIX) && name !== CACHE);
  await Promise.all(old.map((name) => caches.delete(name)));
  await scope.clients.claim();
}

async function answer(request: Request): Promise<Response> {
  const cache = await caches.open(CACHE);
  const kept = await cache.match(request, { ignoreSearch: true });
  if (kept) return kept;
  const sha256 = LATER[new URL(request.url).pathname.split("/").pop() ?? ""];
  return sha256 === undefined ? fetch(request) : fetchLater(request, cache, sha256);
}

/** Fetches a file of `LATER`. A newer version of it on the server does not fit the cached files, and is refused. */
async function fetchLater(request: Request, cache: Cache, sha256: string): Promise<Response> {
  const answer = await fetch(request, { cache: "no-cache" });
  if (!answer.ok) return answer;
  const bytes = await answer.arrayBuffer();
  const found = new Uint8Array(await crypto.subtle.digest("SHA-256", bytes));
  if ([...found].map((byte) => byte.toString(16).padStart(2, "0")).join("") !== sha256) {
    void scope.registration.update();
    return new Response("This file is of another version. Load the page again.", { status: 409 });
  }
  const whole = new Response(bytes, { headers: { "content-type": "application/wasm" } });
  await cache.put(request, whole.clone());
  return whole;
}

scope.addEventListener("install", (event) => event.waitUntil(install()));
scope.addEventListener("activate", (event) => event.waitUntil(activate()));
scope.addEventListener("fetch", (event) => {
  if (event.request.method === "GET") event.respondWith(answer(event.request));
});
