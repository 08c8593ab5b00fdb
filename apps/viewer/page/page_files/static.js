import { embedded } from "./source.js";
import { start } from "./start.js";

start(embedded());
