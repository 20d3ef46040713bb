// Fills the two frames of a comparison with their pages, which share the copy of Meshcat's library in this page.
{
  const library = document.getElementById("meshcat-library").textContent;
  const pages = JSON.parse(document.getElementById("replay-pages").textContent);
  const frames = [...document.querySelectorAll("iframe")];
  // Both captions get the same height, so that both scenes have the same size.
  const align = () => {
    const captions = frames.map(frame => frame.contentDocument.getElementById("replay-caption")).filter(Boolean);
    for (const caption of captions) caption.style.minHeight = "";
    const tallest = Math.max(...captions.map(caption => caption.offsetHeight));
    for (const caption of captions) caption.style.minHeight = tallest + "px";
  };
  frames.forEach((frame, k) => {
    frame.addEventListener("load", align);
    frame.srcdoc = pages[k].join(library);
  });
  window.addEventListener("resize", align);
}
