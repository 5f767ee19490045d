// What every viewer must agree on; the bench takes it from the project's own constants.

export const settings = await (await fetch("/settings.json")).json();
