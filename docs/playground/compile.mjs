// Turns the playground's packages into bytecode, by the Python that will run them: pages start seconds sooner.
// node compile.mjs FOLDER: reads FOLDER/pyodide and FOLDER/packages.zip, and writes the latter anew.
import { readFileSync, writeFileSync } from "node:fs";
import { resolve } from "node:path";
import { pathToFileURL } from "node:url";

const folder = resolve(process.argv[2]);
const { loadPyodide } = await import(pathToFileURL(`${folder}/pyodide/pyodide.mjs`));
const python = await loadPyodide({indexURL: `${folder}/pyodide/`});
python.FS.writeFile("/packages.zip", new Uint8Array(readFileSync(`${folder}/packages.zip`)));
python.runPython(`
import importlib._bootstrap_external as external, importlib.util, zipfile
with zipfile.ZipFile("/packages.zip") as given, zipfile.ZipFile("/compiled.zip", "w", zipfile.ZIP_DEFLATED, compresslevel=9) as made:
    for name in given.namelist():
        data = given.read(name)
        if name.endswith(".py"):
            code = compile(data, "/packages/" + name, "exec", dont_inherit=True, optimize=0)
            data, name = bytes(external._code_to_hash_pyc(code, importlib.util.source_hash(data), False)), name + "c"
        made.writestr(zipfile.ZipInfo(name, (1980, 1, 1, 0, 0, 0)), data, zipfile.ZIP_DEFLATED, 9)
`);
writeFileSync(`${folder}/packages.zip`, python.FS.readFile("/compiled.zip"));
