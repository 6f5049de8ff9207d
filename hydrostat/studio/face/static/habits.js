// Habits of the page: signs of life, keys that the browser keeps for itself, and where the keyboard focus stays.

// A page that is seen gives signs of life, without which motors hold.
export {}; // a module, so that its names are its own

const isMounted = () => "__vue_app__" in (document.getElementById("app") ?? {}); // before, emitEvent has no page to ask
setInterval(() => document.hidden || (isMounted() && window.emitEvent("hydrostat_alive")), 150);

// A clicked button does not keep the focus, or Space would press it instead of starting playback. A button that is
// reached by Tab keeps it.
addEventListener("click", (event) => {
  const letGo = () => {
    const focused = document.activeElement;
    if (focused instanceof HTMLElement && focused.closest("button, [role=button]")) focused.blur();
  };
  if (event.detail) setTimeout(letGo);
});

addEventListener("keydown", (event) => {
  const at = event.target instanceof Element ? event.target : document.body;
  const typing = at.closest("input, textarea, select, [contenteditable=true]");
  const word = (event.ctrlKey || event.metaKey) && "acdsv".includes(event.key.toLowerCase());
  if (word && !typing && !String(getSelection())) event.preventDefault();
  // arrows move the selection, not the page
  const moves = at === document.body || at.closest(".studio-nudges, [role=option], .studio-viewport");
  const plain = !event.ctrlKey && !event.metaKey && !event.altKey;
  if (plain && /^(Arrow|Page)/.test(event.key) && moves) event.preventDefault();
});

// Who works by keys keeps their place when what had the focus is drawn again, hidden or removed.
const CAN_FOCUS = "a[href], button, input, select, textarea, [tabindex]";
const NEAR = 3; // rooms around it in which another control may take the focus

let byKeys = false;
let last = null;

const isSeen = (element) => element.isConnected && element.getClientRects().length > 0 && !element.closest("[inert]");
const canFocus = (element) => element.tabIndex >= 0 && !element.disabled && isSeen(element);
const controlsIn = (room) => [...room.querySelectorAll(CAN_FOCUS)].filter(canFocus);
const nameOf = (element) =>
  [element.tagName, element.dataset.testid, element.ariaLabel ?? (element.innerText || "").trim()].join();

function remember({ target }) {
  const rooms = [];
  for (let room = target.parentElement; room && room !== document.body; room = room.parentElement) rooms.push(room);
  const places = rooms.slice(0, 2 * NEAR).map((room) => controlsIn(room).indexOf(target));
  last = { target, rooms, places, name: nameOf(target) };
}

function successor() {
  const near = last.rooms.map((room, index) => [room, last.places[index] ?? 0]).filter(([room]) => isSeen(room));
  for (const [room, place] of near.slice(0, NEAR)) {
    const found = controlsIn(room);
    if (room.matches(".studio-body, .studio-work")) break;
    if (found.length) return found.find((one) => nameOf(one) === last.name) ?? found[Math.min(place, found.length - 1)];
  }
  return document.querySelector(".studio-viewport");
}

addEventListener("keydown", () => (byKeys = true), true);
addEventListener("pointerdown", () => { byKeys = false; last = null; }, true);
addEventListener("focusin", (event) => byKeys && remember(event));
setInterval(() => {
  if (!byKeys || !last || document.activeElement !== document.body || isSeen(last.target)) return;
  const next = successor();
  last = null;
  if (next && isSeen(next)) next.focus();
}, 150);
