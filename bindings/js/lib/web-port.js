// The worker of a browser, as WorkerLibrary takes it.
export function portOf(worker) {
  return {
    post: (message) => worker.postMessage(message),
    listen: (callback) => (worker.onmessage = ({ data }) => callback(data)),
    fail: (callback) => (worker.onerror = callback),
    busy() {},
    terminate: () => worker.terminate(),
  };
}
