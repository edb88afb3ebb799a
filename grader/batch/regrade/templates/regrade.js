"use strict";
// Shows the rows that hold what is typed, and those that gain or lose; without it all are shown.
const rows = [...document.querySelectorAll("tbody tr[data-change]")];
const words = document.getElementById("words");
const which = document.getElementById("which");
const shown = document.getElementById("shown");
const texts = rows.map((row) => row.textContent.toLowerCase());

function filter() {
  const wanted = words.value.toLowerCase().trim();
  let number = 0;
  rows.forEach((row, n) => {
    const change = Number(row.dataset.change);
    const side = which.value === "" || (which.value === "more" ? change > 0 : which.value === "fewer" ? change < 0 : change === 0);
    row.hidden = !(side && texts[n].includes(wanted));
    number += row.hidden ? 0 : 1;
  });
  shown.textContent = shown.dataset.words.replace("#", number).replace("#", rows.length);
}

if (words && which) {
  document.querySelector(".tools").hidden = false;
  words.addEventListener("input", filter);
  which.addEventListener("change", filter);
  filter();
}
