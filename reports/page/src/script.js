(() => {
  const root = document.documentElement;

  const button = document.getElementById("theme");
  const themes = ["auto", "light", "dark"];
  const current = () => root.dataset.theme || "auto";
  const show = () => { button.textContent = "Theme: " + current(); };
  button.addEventListener("click", () => {
    const next = themes[(themes.indexOf(current()) + 1) % themes.length];
    if (next === "auto") delete root.dataset.theme; else root.dataset.theme = next;
    try {
      if (next === "auto") localStorage.removeItem("theme"); else localStorage.setItem("theme", next);
    } catch {}
    show();
  });
  button.hidden = false;
  show();

  const tables = [...document.querySelectorAll(".scroll")];
  const cut = () => {
    for (const t of tables) t.parentElement.classList.toggle("cut", t.scrollWidth > t.clientWidth + 1);
  };
  addEventListener("resize", cut);
  addEventListener("load", cut);
  cut();

  const links = new Map([...document.querySelectorAll("nav a")].map((a) => [a.hash.slice(1), a]));
  const sections = [...document.querySelectorAll("main > section")];
  let waiting = false;
  const mark = () => {
    waiting = false;
    const line = innerHeight * 0.3;
    let here = sections[0];
    for (const s of sections) if (s.getBoundingClientRect().top <= line) here = s;
    if (innerHeight + scrollY >= root.scrollHeight - 4) here = sections.at(-1);
    for (const [id, a] of links) {
      if (here && id === here.id) a.setAttribute("aria-current", "true");
      else a.removeAttribute("aria-current");
    }
  };
  const later = () => { if (!waiting) { waiting = true; requestAnimationFrame(mark); } };
  addEventListener("scroll", later, { passive: true });
  addEventListener("resize", later);
  mark();
})();
