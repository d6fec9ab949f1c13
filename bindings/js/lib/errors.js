// Errors. Each carries the library's message: one line that names the element and the remedy.

export class LibatlasError extends Error {
  get name() {
    return this.constructor.name;
  }
}
export class CancelledError extends LibatlasError {}
// The data contradicts itself, or holds nothing usable.
export class BadInputError extends LibatlasError {}
// An option is unknown or out of range.
export class BadOptionError extends LibatlasError {}
// Valid, but beyond what this version handles.
export class UnsupportedError extends LibatlasError {}
// More than the pages hold.
export class NoSolutionError extends LibatlasError {}
export class OutOfMemoryError extends LibatlasError {}
// A defect of the library.
export class InternalError extends LibatlasError {}

// By libatlas_status.
const byStatus = [, CancelledError, BadInputError, BadOptionError, UnsupportedError, NoSolutionError, OutOfMemoryError];

export function errorOf(status, message) {
  return new (byStatus[status] ?? InternalError)(message);
}

// Errors cross from a worker as plain objects.
export function packedError(error) {
  return { name: error?.name, message: String(error?.message ?? error) };
}

export function unpackedError({ name, message }) {
  const own = [...byStatus, InternalError, LibatlasError].find((type) => type?.name === name);
  if (own) return new own(message);
  const known = { TypeError, RangeError }[name] ?? Error;
  return new known(message);
}
