// Search over all pages: every word must occur; titles count more than text.
const field = document.querySelector("#search");
const list = document.querySelector("#found");
const around = 60;

function score(page, words) {
  const title = page.title.toLowerCase();
  const text = page.text.toLowerCase();
  let sum = 0;
  for (const word of words) {
    const inText = text.split(word).length - 1;
    const inTitle = title.includes(word) ? 20 : 0;
    if (inText + inTitle === 0) return 0;
    sum += inTitle + Math.min(inText, 10);
  }
  return sum;
}

function excerpt(page, word) {
  const at = page.text.toLowerCase().indexOf(word);
  return at < 0 ? "" : page.text.slice(Math.max(0, at - around), at + around);
}

field.addEventListener("input", () => {
  const words = field.value.toLowerCase().split(/\s+/).filter(Boolean);
  list.replaceChildren();
  if (words.length === 0) return;
  const scored = PAGES.map((page) => [score(page, words), page]);
  const found = scored.filter(([points]) => points > 0).sort(([one], [other]) => other - one);
  for (const [, page] of found.slice(0, 12)) {
    const link = document.createElement("a");
    link.href = ROOT + page.path;
    link.textContent = page.title;
    const text = document.createElement("small");
    text.textContent = excerpt(page, words[0]);
    const item = document.createElement("li");
    item.append(link, document.createElement("br"), text);
    list.append(item);
  }
});
