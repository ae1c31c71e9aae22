"use strict";
// The page of a report: its tables, the choice by weights, its figures out of the plain data in #figures, and its contents.

tabled(document);
weighable(document);

// -- figures -----------------------------------------------------------------------------------------------------

const plots = JSON.parse(document.getElementById("figures").textContent);
const drawings = [...document.querySelectorAll(".drawing")];

/** plotly.js, packed with zlib. */
async function unpacked() {
  const letters = atob(document.getElementById("library").textContent), packed = new Uint8Array(letters.length);
  for (let n = 0; n < letters.length; n += 1) packed[n] = letters.charCodeAt(n);
  const stream = new Blob([packed]).stream().pipeThrough(new DecompressionStream("deflate"));
  return new Response(stream).text();
}

async function drawAll() {
  try {
    const script = document.createElement("script");
    script.textContent = await unpacked();
    document.head.append(script);
    for (const drawing of drawings) {
      await new Promise((next) => setTimeout(next)); // the page answers between one figure and the next
      await draw(drawing, plots[drawing.dataset.plot]);
    }
  } catch (error) {
    for (const drawing of drawings.filter((d) => !d.data)) {
      drawing.textContent = "This browser cannot draw the figures; a current one can.";
      drawing.className = "wanting";
      drawing.style.height = "auto";
    }
    throw error;
  } finally {
    document.documentElement.dataset.drawn = drawings.filter((d) => d.data).length;
  }
}

addEventListener("beforeprint", () => redress(drawings, true));
addEventListener("afterprint", () => redress(drawings, false));
matchMedia("(prefers-color-scheme: dark)").addEventListener("change", () => redress(drawings, false));
drawAll();

// -- contents ----------------------------------------------------------------------------------------------------

const links = new Map([...document.querySelectorAll("nav a")].map((a) => [a.hash.slice(1), a]));
const watch = new IntersectionObserver((entries) => {
  const seen = entries.find((entry) => entry.isIntersecting);
  if (!seen) return;
  for (const [id, link] of links) {
    if (id === seen.target.getAttribute("aria-labelledby")) link.setAttribute("aria-current", "true");
    else link.removeAttribute("aria-current");
  }
}, { rootMargin: "-10% 0px -80% 0px" });
for (const section of document.querySelectorAll("main > section")) watch.observe(section);
const contents = document.querySelector("nav details");
if (matchMedia("(max-width: 62rem)").matches) contents.open = false;
