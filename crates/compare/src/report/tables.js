// Tables that sort by a click on a column's title, and fields that filter their rows.
//
// <table class="sortable" id="ID">: each title in its head becomes a button, unless it holds one or has the
// attribute data-fixed. Cells sort by data-value where they have it, else by their text; cells without a
// value stay at the end. Rows move within their own <tbody> only.
// <input class="filter" data-table="ID">: rows that lack one of its words are hidden.
(() => {
  "use strict";
  const texts = new Intl.Collator(undefined, { numeric: true, sensitivity: "base" });

  // A number, a text, or null for a cell that has no value.
  function valueOf(row, column) {
    const cell = row.cells[column];
    const told = cell?.dataset.value;
    const text = (told ?? cell?.textContent ?? "").trim();
    if (text === "" || text === "-" || text === "–") return null;
    return told !== undefined && Number.isFinite(Number(text)) ? Number(text) : text;
  }

  function compare(a, b) {
    const numbers = typeof a === "number" && typeof b === "number";
    return numbers ? a - b : texts.compare(String(a), String(b));
  }

  function sort(table, title) {
    const falling = title.getAttribute("aria-sort") === "ascending";
    for (const other of table.tHead.querySelectorAll("[aria-sort]")) other.removeAttribute("aria-sort");
    title.setAttribute("aria-sort", falling ? "descending" : "ascending");
    for (const body of table.tBodies) {
      const rows = [...body.rows].map((row) => ({ row, value: valueOf(row, title.cellIndex) }));
      const [valued, empty] = [rows.filter((r) => r.value !== null), rows.filter((r) => r.value === null)];
      valued.sort((a, b) => (falling ? compare(b.value, a.value) : compare(a.value, b.value)));
      body.append(...[...valued, ...empty].map((r) => r.row));
    }
  }

  function makeSortable(table) {
    const titles = table.tHead?.rows[table.tHead.rows.length - 1]?.cells ?? [];
    for (const title of titles) {
      if (title.dataset.fixed !== undefined || !title.textContent.trim()) continue;
      let button = title.querySelector("button");
      if (!button) {
        button = document.createElement("button");
        button.append(...title.childNodes);
        title.append(button);
      }
      button.type = "button";
      button.addEventListener("click", () => sort(table, title));
    }
  }

  function makeFilter(field) {
    const table = document.getElementById(field.dataset.table);
    if (!table) return;
    // Read out when it changes.
    const count = document.createElement("output");
    count.className = "filter-count";
    field.after(count);
    const apply = () => {
      const words = field.value.toLowerCase().split(/\s+/).filter(Boolean);
      const rows = [...table.tBodies].flatMap((body) => [...body.rows]);
      for (const row of rows) {
        const text = row.textContent.toLowerCase();
        row.hidden = !words.every((word) => text.includes(word));
      }
      const shown = rows.filter((row) => !row.hidden).length;
      count.value = words.length ? `${shown} of ${rows.length} rows` : "";
    };
    field.addEventListener("input", apply);
    // A browser may bring back what was typed before.
    if (field.value) apply();
  }

  function start() {
    document.querySelectorAll("table.sortable").forEach(makeSortable);
    document.querySelectorAll("input.filter[data-table]").forEach(makeFilter);
  }

  if (document.readyState === "loading") document.addEventListener("DOMContentLoaded", start);
  else start();
})();
