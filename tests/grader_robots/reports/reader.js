async () => {
  const canvas = document.querySelector("canvas"), paper = canvas.getContext("2d");
  const frame = () => new Promise((done) => requestAnimationFrame(done));
  const look = async () => {
    await frame();
    await frame();
    const all = paper.getImageData(0, 0, canvas.width, canvas.height).data;
    let sum = 0, blue = 0, red = 0;
    for (let k = 0; k < all.length; k += 4 * 3) {
      sum = (sum * 31 + all[k] + 3 * all[k + 1] + 7 * all[k + 2]) % 1000003;
      blue += all[k + 2] > 90 && all[k] < 40 && all[k + 1] < 40;
      red += all[k] > 90 && all[k + 1] < 40 && all[k + 2] < 40;
    }
    return { sum, blue, red };
  };
  const key = (name) => canvas.dispatchEvent(new KeyboardEvent("keydown", { key: name }));
  const drag = (x) => {
    const at = canvas.getBoundingClientRect();
    const steps = [["pointerdown", 0, 1], ["pointermove", x, 1], ["pointerup", x, 0]];
    for (const [kind, across, buttons] of steps) {
      canvas.dispatchEvent(new PointerEvent(kind, {
        pointerId: 1, clientX: at.left + 50 + across, clientY: at.top + 50, buttons,
      }));
    }
  };
  canvas.setPointerCapture = () => {};
  const said = { wide: document.documentElement.scrollWidth - innerWidth, width: innerWidth };
  said.hidden = [...document.querySelectorAll(".still, .turning")].map((part) => part.hidden);
  said.first = await look();
  key("ArrowLeft");
  said.key = await look();
  drag(120);
  said.drag = await look();
  document.querySelector("[data-turn=nearer]").click();
  said.nearer = await look();
  document.querySelector("[data-turn=back]").click();
  said.back = await look();
  const slider = document.querySelector(".player input");
  if (slider) {
    slider.value = 1;
    slider.dispatchEvent(new Event("input"));
    await new Promise((done) => setTimeout(done, 0));
    said.earlier = await look();
  }
  return said;
}
