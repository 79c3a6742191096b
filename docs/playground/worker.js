// Python in a thread of its own: the page asks, this answers in order.
import { loadPyodide } from "./pyodide/pyodide.js";

const say = (text) => postMessage({progress: text});
const bytes = async (file) => {
  const answer = await fetch(file);
  if (!answer.ok) throw new Error(`${file} cannot be read (${answer.status})`);
  return answer.arrayBuffer();
};

async function start() {
  say("Python is loaded …");
  const file = bytes("packages.zip");
  file.catch(() => {});
  const python = await loadPyodide({indexURL: new URL("pyodide/", location.href).href});
  say("robokin is loaded …");
  python.unpackArchive(await file, "zip", {extractDir: "/packages"});
  python.runPython(`import importlib, os, sys
sys.path.insert(0, '/packages')
importlib.invalidate_caches()
os.makedirs('/home/robots')
os.chdir('/home/robots')`);
  const engine = python.pyimport("engine");
  engine.run("fk planar2r --q 0,0");
  say("");
  return engine;
}

const ready = start();
ready.catch((error) => postMessage({fault: String(error.message || error)}));
onmessage = async ({data: {id, call, args}}) => {
  try {
    const engine = await ready, found = engine[call](...args);
    const result = found && found.toJs ? found.toJs({dict_converter: Object.fromEntries}) : found;
    if (found && found.destroy) found.destroy();
    postMessage({id, result});
  } catch (error) {
    postMessage({id, error: String(error.message || error)});
  }
};
