import { kDarkLook, kLightLook } from "./palette";

export const darkPreference = window.matchMedia("(prefers-color-scheme: dark)");

export function currentLook() {
  const printing = document.documentElement.hasAttribute("data-print");
  return darkPreference.matches && !printing ? kDarkLook : kLightLook;
}

export function isDarkLook(): boolean {
  return currentLook() === kDarkLook;
}
