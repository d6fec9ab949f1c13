import { parentPort } from "node:worker_threads";

import { serve } from "./lib/serve.js";

serve({
  post: (message, buffers = []) => parentPort.postMessage(message, buffers),
  listen: (callback) => parentPort.on("message", callback),
});
