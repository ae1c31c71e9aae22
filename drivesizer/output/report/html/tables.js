"use strict";
// Tables that sort, and show at which side they go on; formulas that the keys move.

/** What a cell is sorted by: its number where it has one, else its text; undefined for what is not known. */
function keyOf(cell) {
  const data = cell.querySelector("data");
  if (data) return Number(data.value);
  const text = cell.textContent.trim();
  const number = /^[−-]?\d/.test(text) ? Number.parseFloat(text.replace("−", "-")) : Number.NaN;
  if (!Number.isNaN(number)) return number;
  return text === "" || text === "unknown" ? undefined : text;
}

function compared(a, b) {
  if (typeof a === "number" && typeof b === "number") return a - b;
  return String(a).localeCompare(String(b), "en", { numeric: true });
}

/** Sorts a table by a column: upwards first, the other way when it is so already; what is unknown stays last. */
function sortBy(head) {
  const table = head.closest("table"), body = table.tBodies[0];
  const place = head.cellIndex, way = head.getAttribute("aria-sort") === "ascending" ? -1 : 1;
  const rows = [...body.rows].map((row) => ({ row, key: keyOf(row.cells[place]) }));
  rows.sort((a, b) => {
    if (a.key === undefined || b.key === undefined) return (a.key === undefined) - (b.key === undefined);
    return way * compared(a.key, b.key);
  });
  body.append(...rows.map(({ row }) => row));
  for (const other of table.tHead.rows[0].cells) if (other.hasAttribute("aria-sort")) other.setAttribute("aria-sort", "none");
  head.setAttribute("aria-sort", way === 1 ? "ascending" : "descending");
}

/** Shows at which side a table goes on. */
function cue(box) {
  const rest = box.scrollWidth - box.clientWidth - box.scrollLeft;
  box.parentElement.classList.toggle("more", rest > 1);
  box.parentElement.classList.toggle("before", box.scrollLeft > 1);
}

const resized = new ResizeObserver((entries) => { for (const { target } of entries) cue(target); });

// A formula that is wider than its place is moved with the keys too; of those that fit none is a stop of the tab key.
const fitted = new ResizeObserver((entries) => {
  for (const { target } of entries) {
    if (target.scrollWidth > target.clientWidth) target.tabIndex = 0;
    else target.removeAttribute("tabindex");
  }
});

/** Makes the tables below an element sort, and show where they go on. */
function tabled(root) {
  for (const button of root.querySelectorAll(".sortable thead button")) {
    button.addEventListener("click", () => sortBy(button.closest("th")));
  }
  for (const cell of root.querySelectorAll(".sets.sortable tbody td")) {
    cell.dataset.head = cell.closest("table").tHead.rows[0].cells[cell.cellIndex].textContent;
  }
  for (const box of root.querySelectorAll(".scroll")) {
    box.addEventListener("scroll", () => cue(box), { passive: true });
    resized.observe(box);
  }
  for (const formula of root.querySelectorAll(".step dd")) fitted.observe(formula);
}
