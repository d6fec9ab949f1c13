import { serve } from "./lib/serve.js";

serve({
  post: (message, buffers = []) => self.postMessage(message, buffers),
  listen: (callback) => (self.onmessage = ({ data }) => callback(data)),
});
