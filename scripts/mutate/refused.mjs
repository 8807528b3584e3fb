// What the user can mend; one line says how.
export class Refused extends Error {}
