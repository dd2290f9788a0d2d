// Tapping a badge: a colour and four pictures, in the order in which they are tapped.
"use strict";
const chosen = document.getElementById("chosen");
if (chosen) {
  let colour = null;
  let pictures = [];
  const show = () => {
    chosen.replaceChildren();
    for (const key of [colour, ...pictures]) {
      if (key) chosen.append(key.querySelector("svg").cloneNode(true));
    }
    for (const key of document.querySelectorAll("[data-colour]")) {
      key.setAttribute("aria-pressed", String(key === colour));
    }
    if (colour && pictures.length === 4) {
      const numbers = pictures.map((key) => key.dataset.picture).join("-");
      location.assign("/staff/find?colour=" + colour.dataset.colour + "&pictures=" + numbers);
    }
  };
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
