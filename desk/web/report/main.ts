import { buildPage } from "./page";

buildPage();
