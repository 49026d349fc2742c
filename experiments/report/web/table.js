'use strict';
// The table of results: sorted by its headings, filtered by words, columns added and taken away.

(() => {
  const table = document.getElementById('results'), body = table.tBodies[0], head = table.tHead.rows[0];
  const { columns, rows: values } = JSON.parse(document.getElementById('numbers').textContent);
  const filter = document.getElementById('filter'), count = document.getElementById('count');
  // as they came; the page has them in another order once they are sorted
  const rows = [...body.rows];

  function compare(first, second) {
    if (typeof first === 'number' && typeof second === 'number') return first - second;
    return String(first).localeCompare(String(second));
  }

  function sort(heading) {
    const column = columns.indexOf(heading.dataset.column);
    const sign = heading.getAttribute('aria-sort') === 'ascending' ? -1 : 1;
    for (const other of head.cells) other.removeAttribute('aria-sort');
    heading.setAttribute('aria-sort', sign > 0 ? 'ascending' : 'descending');
    const order = rows.map((_, row) => row).sort((a, b) => {
      const [first, second] = [values[a][column], values[b][column]];
      // what is empty stands last, whichever way round
      if (first === null || second === null) return (first === null) - (second === null);
      return sign * compare(first, second);
    });
    body.append(...order.map((row) => rows[row]));
  }

  // words, all of which a row holds; or column>number and column<number, the column by the end of its name
  function test(word) {
    const asked = /^(.+)([<>])(-?[\d.]+(?:e[-+]?\d+)?)$/.exec(word);
    if (!asked) return (row) => row.some((value) => String(value ?? '').toLowerCase().includes(word));
    const column = columns.findIndex((name) => name.toLowerCase().endsWith(asked[1])), limit = Number(asked[3]);
    return (row) => typeof row[column] === 'number' && (asked[2] === '<' ? row[column] < limit : row[column] > limit);
  }

  function sift() {
    const tests = filter.value.toLowerCase().split(/\s+/).filter(Boolean).map(test);
    values.forEach((row, number) => (rows[number].hidden = !tests.every((holds) => holds(row))));
    count.textContent = `${rows.filter((row) => !row.hidden).length} of ${rows.length} rows`;
  }

  function add(name) {
    const heading = head.appendChild(document.createElement('th')), button = heading.appendChild(document.createElement('button'));
    heading.scope = 'col';
    heading.dataset.column = button.textContent = name;
    const column = columns.indexOf(name);
    rows.forEach((row, number) => {
      const value = values[number][column], cell = row.insertCell();
      if (typeof value === 'number') cell.className = 'number';
      cell.textContent = typeof value === 'number' ? Number(value.toPrecision(4)) : value;
    });
  }

  function remove(name) {
    const place = [...head.cells].findIndex((heading) => heading.dataset.column === name);
    head.deleteCell(place);
    for (const row of rows) row.deleteCell(place);
  }

  head.addEventListener('click', (event) => {
    const heading = event.target.closest('th');
    if (heading) sort(heading);
  });
  filter.addEventListener('input', sift);
  document.getElementById('columns').addEventListener('change', (event) => {
    (event.target.checked ? add : remove)(event.target.value);
  });
  sift();
})();
