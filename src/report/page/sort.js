// Tables sort by a click on a column's heading. Without scripting they stay as they are.
"use strict";
for (const table of document.querySelectorAll("table.sortable")) {
  const body = table.tBodies[0];
  const original = [...body.rows];
  const heads = [...table.tHead.rows[0].cells];
  heads.forEach((head, column) => {
    const button = document.createElement("button");
    button.type = "button";
    button.title = "Sort by this column";
    button.append(...head.childNodes);
    head.append(button);
    button.addEventListener("click", () => {
      const next = { none: "descending", descending: "ascending", ascending: "none" };
      const order = next[head.getAttribute("aria-sort") || "none"];
      heads.forEach((other) => other.removeAttribute("aria-sort"));
      if (order !== "none") head.setAttribute("aria-sort", order);
      body.append(...sorted(original, column, order));
    });
  });
}

function sorted(rows, column, order) {
  if (order === "none") return rows;
  const sign = order === "ascending" ? 1 : -1;
  return [...rows].sort((a, b) => {
    const [p, q] = [key(a.cells[column]), key(b.cells[column])];
    // missing values stay at the end in both orders
    if (p === null || q === null) return (p === null) - (q === null);
    const difference = typeof p === "number" && typeof q === "number"
      ? p - q || 0
      : String(p).localeCompare(String(q), "en", { numeric: true });
    return sign * difference;
  });
}

function key(cell) {
  const value = cell.dataset.value;
  if (value === undefined) return cell.textContent.trim() || null;
  return value === "" ? null : Number(value);
}
