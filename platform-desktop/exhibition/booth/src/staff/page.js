// Tapping a badge: a colour and four pictures, in the order in which they are tapped.
"use strict";
const chosen = document.getElementById("chosen");
if (chosen) {
  let colour = null;
  let pictures = [];
  const search = document.getElementById("search");
  const show = () => {
    chosen.replaceChildren();
    for (const key of [colour, ...pictures]) {
      if (key) chosen.append(key.querySelector("svg").cloneNode(true));
    }
    for (const key of document.querySelectorAll("[data-colour]")) {
      key.setAttribute("aria-pressed", String(key === colour));
    }
    search.disabled = !colour && pictures.length === 0;
    if (colour && pictures.length === 4) find();
  };
  const find = () => {
    const numbers = pictures.map((key) => key.dataset.picture).join("-");
    location.assign("/staff/find?colour=" + (colour ? colour.dataset.colour : "") + "&pictures=" + numbers);
  };
  search.addEventListener("click", find);
  for (const key of document.querySelectorAll("[data-colour]")) {
    key.addEventListener("click", () => { colour = key; show(); });
  }
  for (const key of document.querySelectorAll("[data-picture]")) {
    key.addEventListener("click", () => { if (pictures.length < 4) pictures.push(key); show(); });
  }
  document.getElementById("back").addEventListener("click", () => {
    if (pictures.length > 0) pictures.pop(); else colour = null;
    show();
  });
  // Back from a result, nothing is chosen any more.
  addEventListener("pageshow", () => { colour = null; pictures = []; show(); });
}
const slip = document.getElementById("print-slip");
if (slip) slip.addEventListener("click", () => print());
// Parts of a page that follow what changes: the page reads itself again, and takes over what is otherwise.
const parts = [...document.querySelectorAll("[data-live]")];
if (parts.length > 0) {
  let events = null;
  let isReading = false;
  let isLate = false;
  let wasOpen = false;
  const take = (part, fresh) => {
    if (!fresh || part.isEqualNode(fresh)) return;
    const held = part.contains(document.activeElement) && document.activeElement.closest("a, form");
    // What stays the same stays there, with its picture.
    const kept = new Map();
    for (const item of part.querySelectorAll("li")) kept.set(item.outerHTML, item);
    for (const item of fresh.querySelectorAll("li")) {
      const same = kept.get(item.outerHTML);
      if (same) item.replaceWith(same);
    }
    part.replaceChildren(...fresh.childNodes);
    if (!held) return;
    const key = held.getAttribute("href") || held.getAttribute("action");
    const again = [...part.querySelectorAll("a, form")].find((other) => key === (other.getAttribute("href") || other.getAttribute("action")));
    if (again) (again.querySelector("button") || again).focus({ preventScroll: true });
  };
  const read = async () => {
    // Nothing moves away under a finger.
    if (isReading || parts.some((part) => part.querySelector(":active"))) { isLate = true; return; }
    isReading = true;
    try {
      const answer = await fetch(location.href, { headers: { "paros-live": "1" } });
      if (answer.redirected || answer.status === 404) location.reload();
      if (answer.ok) {
        const page = new DOMParser().parseFromString(await answer.text(), "text/html");
        for (const part of parts) take(part, page.getElementById(part.id));
      }
    } catch (error) {
      console.info(error);
    }
    isReading = false;
  };
  const follow = () => {
    if (events) events.close();
    events = null;
    if (document.hidden) return;
    events = new EventSource("/staff/changes");
    // What changed while nobody listened.
    events.onopen = () => { if (wasOpen) read(); wasOpen = true; };
    events.onmessage = read;
    events.addEventListener("ended", () => location.reload());
  };
  document.addEventListener("visibilitychange", follow);
  setInterval(() => { if (isLate) { isLate = false; read(); } }, 500);
  follow();
}
// Screen readers say what comes into a status; what is there from the start they may pass over.
const done = document.getElementById("done");
if (done) {
  const text = done.textContent;
  done.textContent = "";
  setTimeout(() => { done.textContent = text; }, 100);
}
// A refused form is where one was, not at the top of its page.
const reason = document.getElementById("reason");
if (reason) {
  const field = document.querySelector("[aria-invalid]");
  if (field) field.focus({ preventScroll: true });
  (field || reason).scrollIntoView({ block: "center" });
}
// Files of an outbox go one by one: each is as large as a parcel, and has an outcome of its own.
const outbox = document.getElementById("import");
if (outbox) {
  const list = document.getElementById("imported");
  const send = async (file) => {
    const path = "/staff/import/" + outbox.elements.headset.value + "/" + encodeURIComponent(file.name);
    const headers = { form: outbox.elements.form.value };
    const answer = await fetch(path, { method: "PUT", headers, body: file });
    const text = await answer.text();
    if (answer.ok) return text;
    const note = new DOMParser().parseFromString(text, "text/html").querySelector(".note");
    return note ? note.textContent : list.dataset.failed;
  };
  outbox.addEventListener("submit", async (event) => {
    event.preventDefault();
    const button = outbox.querySelector("button");
    button.disabled = true;
    list.replaceChildren();
    for (const file of outbox.elements.files.files) {
      const told = await send(file).catch(() => list.dataset.failed);
      const line = document.createElement("li");
      line.textContent = file.name + ": " + told;
      list.append(line);
    }
    button.disabled = false;
  });
}
