/** Ranges of cells in an address: `3-5,9`. */

export function formatCells(cells: Iterable<number>): string {
  const runs: [first: number, last: number][] = [];
  for (const cell of [...cells].sort((a, b) => a - b)) {
    const run = runs.at(-1);
    if (run && cell <= run[1] + 1) run[1] = cell;
    else runs.push([cell, cell]);
  }
  return runs.map(([first, last]) => (first === last ? first : `${first}-${last}`)).join();
}

/** A test for the cells in a text; malformed ranges are ignored. */
export function parseCells(text: string): (cell: number) => boolean {
  const runs = text.split(",").flatMap((run): [number, number][] => {
    const [, first, last] = /^(\d+)(?:-(\d+))?$/.exec(run) ?? [];
    return first === undefined ? [] : [[Number(first), Number(last ?? first)]];
  });
  return (cell) => runs.some(([first, last]) => first <= cell && cell <= last);
}
