// Finding one's way: the contents mark what is being read, a link into a folded section opens it.
// (the page's first script: it waits for nothing)
{
  const links = [...document.querySelectorAll("nav a")];
  const target = (link) => document.getElementById(decodeURIComponent(link.hash.slice(1)));
  const open = (link) => {
    const folded = target(link)?.querySelector("details.folded");
    if (folded) folded.open = true;
  };
  links.forEach((link) => link.addEventListener("click", () => open(link)));
  const named = links.find((link) => link.hash === location.hash && location.hash);
  if (named) open(named);
  const mark = () => {
    const passed = links.filter((link) => target(link).getBoundingClientRect().top < innerHeight / 3);
    const end = innerHeight + scrollY >= document.documentElement.scrollHeight - 2;
    const here = end ? links.at(-1) : passed.at(-1) || links[0];
    links.forEach((link) => (link === here
      ? link.setAttribute("aria-current", "true")
      : link.removeAttribute("aria-current")));
  };
  if (links.length) {
    addEventListener("scroll", mark, { passive: true });
    addEventListener("resize", mark);
    mark();
  }
}
