/** What stands at a place that the list is known to have. */
export function itemAt<Item>(list: readonly Item[], index: number): Item {
  if (index < 0 || index >= list.length) throw new RangeError(`place ${index} of a list of ${list.length}`);
  return list[index] as Item;
}
