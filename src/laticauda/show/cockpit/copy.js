// What a button that copies does. Browsers let a page write to the clipboard only if it comes from this computer, or
// by https; else by the old way.
const t={text},b=this,s=b.textContent,done=()=>{{b.textContent='copied';setTimeout(()=>b.textContent=s,1200)}};
if(navigator.clipboard)navigator.clipboard.writeText(t).then(done);
else{{const a=document.createElement('textarea');a.value=t;document.body.append(a);a.select();
document.execCommand('copy');a.remove();done()}}
